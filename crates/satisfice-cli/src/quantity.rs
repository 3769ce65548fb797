//! Times, counts and settings as they are written on a command line.

pub(crate) use satisfice_catalogue::quantity::{count, not_negative, setting, threads, time, width};
