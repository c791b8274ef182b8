//! The program `deltarobot-ui`.

use std::process::ExitCode;

fn main() -> ExitCode {
    deltarobot_serve::ui()
}
