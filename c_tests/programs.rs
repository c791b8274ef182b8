//! Each program linked statically, linked to the shared library, under the sanitizers, under valgrind, and for
//! other sizes than the default, as far as these concern it.

use crate::support::{
    DEFAULT, Family, Language, Library, MODEL, Mode, Program, SMALLEST, Sizes, build, check, command, run, text,
};

/// The programs of a subject: each file of its directory is one.
macro_rules! programs {
    ($($subject:ident($family:ident): $($name:ident.$extension:ident)*;)*) => {$(
        mod $subject {
            use super::*;

            in_every_mode! {$(
                $name: Program::of(
                    concat!(stringify!($subject), "_", stringify!($name)),
                    &[concat!(stringify!($subject), "/", stringify!($name), ".", stringify!($extension))],
                ).family(Family::$family);
            )*}
        }
    )*};
}

macro_rules! in_every_mode {
    ($($name:ident: $program:expr;)*) => {$(
        mod $name {
            use super::*;

            #[test]
            fn linked_statically() {
                check(&$program, DEFAULT, Mode::Static, $program.args(Mode::Static));
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
            fn with_small_leaves() {
                check::<&str>(&$program, DEFAULT, Mode::SmallLeaves, &[]);
            }

            #[test]
            fn under_valgrind() {
                check(&$program, DEFAULT, Mode::Valgrind, $program.args(Mode::Valgrind));
            }

            #[test]
            fn for_other_sizes() {
                for sizes in $program.other_sizes() {
                    check::<&str>(&$program, sizes, Mode::Sanitized, &[]);
                }
            }
        }
    )*};
}

programs! {
    deltarobot(Deltarobot): better.c controller.c ext.c host_link.c host_session.c hostile.c
        values_cpp.cpp payload.c pc_utils.cpp receiver.c reentrant.c threads.c;
    gx(Gx): contour.c contouring.c host.c hostile.c messages.c motion.c streams.c;
    line(Line): conversation.c device.c device_calls.c encoder.c host.c host_link.c messages.c;
    serial(Serial): serial.c;
}

/// Those that more is to be said of.
mod special {
    use super::*;

    in_every_mode! {
        gx_channel: Program::of("gx_channel", &["gx/channel.c"]).family(Family::Gx).slowly(&["300"]);
        gx_real_links: Program::of("gx_real_links", &["gx/real_links.c"]).family(Family::Gx).slowly(&["300"]).fully(&["100000"]);
        kinematics: Program::of("kinematics", &["kinematics/kinematics.c"]).family(Family::Serial).slowly(&["3000"]);
        values: Program::of("values", &["deltarobot/values.c"]).language(Language::C11);
        line_channel: Program::of("line_channel", &["line/channel.c"]).family(Family::Line).slowly(&["300"]);
        line_real_links: Program::of("line_real_links", &["line/real_links.c"]).family(Family::Line).slowly(&["500"]).fully(&["1"]);
        cross_comm: Program::of("cross_comm", &["../test/cross_comm.cpp"]);
        noise: Program::of("noise", &["deltarobot/noise.c", MODEL]);
        robot: Program::of("robot", &["kinematics/robot.cpp"]).family(Family::Serial).needs_eigen();
        session_channel: Program::of("session_channel", &["deltarobot/session_channel.c"]).slowly(&["300"]);
        two_units: Program::of("two_units", &["deltarobot/two_units_a.c", "deltarobot/two_units_b.c"]);
    }
}

/// Every stream of what matters, for the smallest rings.
mod exhaustive {
    use super::*;

    const PROGRAM: Program = Program::of("exhaustive", &["deltarobot/exhaustive.c"]);
    const PAYLOADS_OF_TWO: Sizes = Sizes::new(7, 2);

    #[test]
    fn streams_of_nine_bytes() {
        check(&PROGRAM, PAYLOADS_OF_TWO, Mode::Static, &["9"]);
    }

    #[test]
    fn streams_of_eight_bytes_with_small_leaves() {
        check(&PROGRAM, PAYLOADS_OF_TWO, Mode::SmallLeaves, &["8"]);
    }

    #[test]
    fn the_smallest_ring() {
        check(&PROGRAM, SMALLEST, Mode::Sanitized, &["7"]);
    }
}

/// Too much for valgrind: it feeds all that four bytes can be.
mod gx_exhaustive {
    use super::*;

    const PROGRAM: Program = Program::of("gx_exhaustive", &["gx/exhaustive.c"]);

    #[test]
    fn every_input_of_four_bytes() {
        check(&PROGRAM, DEFAULT, Mode::Static, &["4"]);
    }

    #[test]
    fn under_the_sanitizers() {
        check(&PROGRAM, DEFAULT, Mode::Sanitized, &["2"]);
    }
}

/// `send_opcode` is driven over a pseudo-terminal by `pty_run`.
mod send_opcode {
    use super::*;

    const SEND_OPCODE: Program = Program::of("send_opcode", &["../test/send_opcode.c"]);
    const PTY_RUN: Program = Program::of("pty_run", &["deltarobot/pty_run.c"]);

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

/// The line protocol's demonstration: the devices and the PC program have to be content with each other, and the PC
/// program must not be content with anything.
mod line_demonstration {
    use super::*;

    const DEMO: Program = Program::of("demo", &["../examples/demo.c"]);
    const PC: Program = Program::of("line_pc", &["../examples/line/pc.c"]);
    const DEVICE: Program = Program::of("line_device_example", &["../examples/line/device.c"]);

    fn run_with(device: Option<&Program>, mode: Mode) -> Option<std::process::Output> {
        let library = Library::of(DEFAULT);
        let (demo, pc) = (build(&DEMO, &library, mode)?, build(&PC, &library, mode)?);
        let mut command = command(&demo, &library, mode);
        command.arg("--line").arg(pc);
        match device {
            Some(device) => command.arg(build(device, &library, mode)?),
            None => command.args(["/bin/sleep", "3"]),
        };
        Some(run(&mut command))
    }

    #[test]
    fn all_is_as_expected() {
        for mode in [Mode::Sanitized, Mode::Shared] {
            let output = run_with(Some(&DEVICE), mode).unwrap();
            assert!(output.status.success() && text(&output).ends_with("all as expected\n"), "{}", text(&output));
        }
    }

    #[test]
    fn nothing_is_as_expected() {
        let output = run_with(None, Mode::Sanitized).unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", text(&output));
        assert!(
            text(&output).contains("!! expected three devices") && text(&output).contains("FAILED"),
            "{}",
            text(&output)
        );
    }
}

/// The GX protocol's demonstration: the machine and the host program have to be content with each other, but not when
/// the machine has an axis more than the host program expects.
mod gx_demonstration {
    use super::*;

    const DEMO: Program = Program::of("gx_demo", &["../examples/demo.c"]);
    const HOST: Program = Program::of("gx_host_example", &["../examples/gx/host.c"]);
    const MOTION: Program = Program::of("gx_motion_example", &["../examples/gx/motion.c"]);

    fn run_with(axes: &str, mode: Mode) -> std::process::Output {
        let library = Library::of(DEFAULT);
        let [demo, host, motion] = [DEMO, HOST, MOTION].map(|program| build(&program, &library, mode).unwrap());
        run(command(&demo, &library, mode).arg("--line").arg(host).arg(motion).arg(axes))
    }

    #[test]
    fn all_is_as_expected() {
        for (axes, mode) in [("3", Mode::Sanitized), ("4", Mode::Shared)] {
            let output = run_with(axes, mode);
            assert!(output.status.success() && text(&output).ends_with("all as expected\n"), "{}", text(&output));
        }
    }

    #[test]
    fn an_axis_too_many_is_noticed() {
        let output = run_with("6", Mode::Static);
        assert_eq!(output.status.code(), Some(1), "{}", text(&output));
        assert!(text(&output).contains("!! expected one move refused"), "{}", text(&output));
    }
}

/// Only the serial port needs anything, and it is an object of its own.
#[test]
fn the_archive_needs_nothing_but_for_the_serial_port() {
    let library = Library::of(DEFAULT);
    let output = run(std::process::Command::new("nm").arg("--undefined-only").arg(library.archive()));
    assert!(output.status.success(), "{}", text(&output));
    let undefined = String::from_utf8(output.stdout).unwrap();
    let (others, serial) = undefined.split_once("serial.o:").unwrap();
    assert!(!others.contains(" U "), "the archive asks for something: {others}");
    assert!(serial.contains(" open"), "{serial}");
}

/// A program that links the archive carries the parts that it uses, even if nobody tells the linker to drop the rest.
#[test]
fn a_small_program_stays_small() {
    let library = Library::of(DEFAULT);
    let small = Program::of("small", &["packaging/small.c"]).flags(&["-Os", "-g0"]);
    let program = build(&small, &library, Mode::Static).unwrap();
    let output = run(std::process::Command::new("size").arg(program));
    let sizes = text(&output);
    let bytes: usize = sizes.lines().nth(1).and_then(|line| line.split_whitespace().next()).unwrap().parse().unwrap();
    assert!(bytes <= 12 * 1024, "{sizes}");
}
