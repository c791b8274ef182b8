//! The program `deltarobot`.

use std::process::ExitCode;

fn main() -> ExitCode {
    deltarobot_cli::main()
}
