//! Times, counts and settings as they are written on a command line.

pub(crate) use satisfice_catalogue::quantity::{
    count, not_negative, retries, setting, threads, time, width, workers,
};
