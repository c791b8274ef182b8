//! `deltarobot serve`: owns the ports of robots, and lets many programs watch and drive them.
#![forbid(unsafe_code)]

pub mod station;
