//! The program `deltarobot-convert`, which `deltarobot convert` runs.

use std::process::ExitCode;

fn main() -> ExitCode {
    deltarobot_records::main()
}
