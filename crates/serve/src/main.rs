//! The program `deltarobot-serve`.
fn main() {}
