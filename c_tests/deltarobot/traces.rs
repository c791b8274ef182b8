//! The recordings of the reference library, replayed through the C ABI, and against the model of the reference.

use std::path::PathBuf;

use crate::support::{
    DEFAULT, LARGEST, Library, MODEL, Mode, Program, Sizes, build, c_tests, check, command, compiler, out_dir, run,
    text,
};

const REPLAY: Program = Program::of("replay", &["deltarobot/replay.c"]);
const KINDS: [&str; 4] = ["clean", "tricky", "noise", "overflow"];

fn trace(name: &str) -> PathBuf {
    c_tests().join("deltarobot/traces").join(name)
}

fn traces_of(sizes: Sizes) -> Vec<PathBuf> {
    let Sizes { bufsize, data_max, .. } = sizes;
    let mut traces: Vec<_> = KINDS.iter().map(|kind| trace(&format!("{kind}.{bufsize}-{data_max}.txt"))).collect();
    if data_max >= 32 {
        traces.push(trace("send.32.txt"));
    }
    traces
}

/// The model is no library of ours: it is compiled into the program.
fn check_model(sizes: Sizes) {
    let executable = out_dir().join(format!("replay-model-{sizes}"));
    let mut compile = compiler(false);
    compile
        .current_dir(c_tests())
        .args(["-std=c99", "-DUSE_MODEL", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-Icommon"])
        .arg(format!("-DDP_BUFSIZE={}", sizes.bufsize))
        .arg(format!("-DDP_DATA_MAX_SIZE={}", sizes.data_max))
        .args(["deltarobot/replay.c", MODEL, "-o"])
        .arg(&executable);
    let output = run(&mut compile);
    assert!(output.status.success(), "the model does not compile:\n{}", text(&output));
    let output = run(std::process::Command::new(&executable).args(traces_of(sizes)));
    assert!(output.status.success(), "the model is not the reference:\n{}", text(&output));
}

macro_rules! replayed {
    ($($name:ident: $sizes:expr;)*) => {$(
        mod $name {
            use super::*;

            const SIZES: Sizes = $sizes;

            #[test]
            fn linked_statically() {
                check(&REPLAY, SIZES, Mode::Static, &traces_of(SIZES));
            }

            #[test]
            fn linked_to_the_shared_library() {
                check(&REPLAY, SIZES, Mode::Shared, &traces_of(SIZES));
            }

            #[test]
            fn under_the_sanitizers() {
                check(&REPLAY, SIZES, Mode::Sanitized, &traces_of(SIZES));
            }

            #[test]
            fn with_small_leaves() {
                check(&REPLAY, SIZES, Mode::SmallLeaves, &traces_of(SIZES));
            }

            #[test]
            fn under_valgrind() {
                check(&REPLAY, SIZES, Mode::Valgrind, &traces_of(SIZES));
            }

            #[test]
            fn by_the_model() {
                check_model(SIZES);
            }
        }
    )*};
}

replayed! {
    sizes_128_32: DEFAULT;
    sizes_256_32: Sizes::new(256, 32);
    sizes_512_255: LARGEST;
}

#[test]
fn a_recording_of_other_sizes_is_refused() {
    let library = Library::of(Sizes::new(101, 17));
    let replay = build(&REPLAY, &library, Mode::Static).unwrap();
    let output = run(command(&replay, &library, Mode::Static).arg(trace("clean.128-32.txt")));
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(text(&output).contains("recorded for 128/32, compiled for 101/17"), "{}", text(&output));
}
