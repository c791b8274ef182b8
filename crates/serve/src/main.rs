//! The program `deltarobot-serve`, which `deltarobot serve` runs.

use std::process::ExitCode;

fn main() -> ExitCode {
    deltarobot_serve::main()
}
