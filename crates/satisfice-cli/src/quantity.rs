//! Times, counts and settings as they are written on a command line.

pub(crate) use satisfice_catalogue::quantity::{
    count, islands, positive, seed, setting, share, threads, time, width,
};
