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
    cross_comm: Program::c99("cross_comm", &["cross_comm.cpp"]).language(Language::Cpp98);
    ext: Program::c99("ext", &["ext.c"]);
    hostile: Program::c99("hostile", &["hostile.c"]);
    layout: Program::c99("layout", &["layout.c"]).language(Language::C11);
    layout_cpp: Program::c99("layout_cpp", &["layout_cpp.cpp"]).language(Language::Cpp98);
    noise: Program::c99("noise", &["noise.c", MODEL]);
    reentrant: Program::c99("reentrant", &["reentrant.c"]);
    threads: Program::c99("threads", &["threads.c"]);
    two_units: Program::c99("two_units", &["two_units_a.c", "two_units_b.c"]);
}

/// The demonstration: its controller and its host have to be content with each other.
mod demo {
    use super::*;

    const DEMO: Program = Program::c99("demo", &["demo/demo.c", "demo/line.c"]);
    const CONTROLLER: Program = Program::c99("demo_controller", &["demo/controller.c", "demo/robot.c", "demo/line.c"]);
    const HOST: Program = Program::c99("demo_host", &["demo/host.c", "demo/robot.c", "demo/line.c"]);

    #[test]
    fn under_the_sanitizers() {
        let library = Library::of(DEFAULT);
        let [demo, controller, host] =
            [DEMO, CONTROLLER, HOST].map(|program| build(&program, &library, Mode::Sanitized).expect("always built"));
        let output = run(command(&demo, &library, Mode::Sanitized).args([controller, host]));
        assert!(output.status.success(), "{}", text(&output));
    }
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

/// Whatever a program includes besides, a library that takes no memory and knows no files needs none of these.
#[test]
fn the_archive_needs_nothing() {
    let library = Library::of(DEFAULT);
    let output = run(std::process::Command::new("nm").arg("--undefined-only").arg(library.archive()));
    assert!(output.status.success(), "{}", text(&output));
    let undefined = String::from_utf8(output.stdout).unwrap();
    let symbols: Vec<_> = undefined.lines().filter(|line| line.contains(" U ")).collect();
    assert!(symbols.is_empty(), "the archive asks for {symbols:?}");
}
