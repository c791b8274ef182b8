//! Each program linked statically, linked to the shared library, under the sanitizers, under valgrind, and for
//! other sizes than the default.

use crate::support::{DEFAULT, Language, Library, MODEL, Mode, OTHERS, Program, build, check, command, run, text};

macro_rules! in_every_mode {
    ($($name:ident: $program:expr;)*) => {$(
        mod $name {
            use super::*;

            #[test]
            fn linked_statically() {
                check::<&str>(&$program, DEFAULT, Mode::Static, &[]);
            }

            #[test]
            fn linked_to_the_shared_library() {
                check::<&str>(&$program, DEFAULT, Mode::Shared, &[]);
            }

            #[test]
            fn under_the_sanitizers() {
                check::<&str>(&$program, DEFAULT, Mode::Sanitized, &[]);
            }

            #[test]
            fn under_valgrind() {
                check::<&str>(&$program, DEFAULT, Mode::Valgrind, &[]);
            }

            #[test]
            fn for_other_sizes() {
                for sizes in OTHERS {
                    check::<&str>(&$program, sizes, Mode::Sanitized, &[]);
                }
            }
        }
    )*};
}

in_every_mode! {
    better: Program::c99("better", &["better.c"]);
    controller: Program::c99("controller", &["controller.c"]);
    cross_comm: Program::c99("cross_comm", &["cross_comm.cpp"]).language(Language::Cpp98);
    ext: Program::c99("ext", &["ext.c"]);
    hostile: Program::c99("hostile", &["hostile.c"]);
    host_link: Program::c99("host_link", &["host_link.c"]);
    host_session: Program::c99("host_session", &["host_session.c"]);
    layout: Program::c99("layout", &["layout.c"]).language(Language::C11);
    layout_cpp: Program::c99("layout_cpp", &["layout_cpp.cpp"]).language(Language::Cpp98);
    layout_session: Program::c99("layout_session", &["layout_session.c"]).language(Language::C11);
    noise: Program::c99("noise", &["noise.c", MODEL]);
    payload: Program::c99("payload", &["payload.c"]);
    pc_utils: Program::c99("pc_utils", &["pc_utils.cpp"]).language(Language::Cpp98);
    reentrant: Program::c99("reentrant", &["reentrant.c"]);
    serial: Program::c99("serial", &["serial.c"]);
    session_channel: Program::c99("session_channel", &["session_channel.c"]);
    threads: Program::c99("threads", &["threads.c"]);
    two_units: Program::c99("two_units", &["two_units_a.c", "two_units_b.c"]);
}

/// `send_opcode` is driven over a pseudo-terminal by `pty_run`.
mod send_opcode {
    use super::*;

    const SEND_OPCODE: Program = Program::c99("send_opcode", &["send_opcode.c"]);
    const PTY_RUN: Program = Program::c99("pty_run", &["pty_run.c"]);

    fn over_a_pseudo_terminal(mode: Mode) {
        let library = Library::of(DEFAULT);
        let (Some(program), Some(driver)) = (build(&SEND_OPCODE, &library, mode), build(&PTY_RUN, &library, mode))
        else {
            return;
        };
        let output = run(command(&driver, &library, mode).arg(program));
        assert!(output.status.success(), "{}", text(&output));
    }

    #[test]
    fn linked_statically() {
        over_a_pseudo_terminal(Mode::Static);
    }

    #[test]
    fn linked_to_the_shared_library() {
        over_a_pseudo_terminal(Mode::Shared);
    }

    #[test]
    fn under_the_sanitizers() {
        over_a_pseudo_terminal(Mode::Sanitized);
    }

    #[test]
    fn under_valgrind() {
        over_a_pseudo_terminal(Mode::Valgrind);
    }
}

/// Only the serial port needs anything, and it is an object of its own.
#[test]
fn the_archive_needs_nothing_but_for_the_serial_port() {
    let library = Library::of(DEFAULT);
    let output = run(std::process::Command::new("nm").arg("--undefined-only").arg(library.archive()));
    assert!(output.status.success(), "{}", text(&output));
    let undefined = String::from_utf8(output.stdout).unwrap();
    let (_, objects) = undefined.split_once("deltarobot.o:").unwrap();
    let (deltarobot, serial) = objects.split_once("serial.o:").unwrap();
    assert_eq!(deltarobot.trim(), "", "the archive asks for something");
    assert!(serial.contains(" open"), "{serial}");
}
