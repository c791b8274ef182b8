//! The headers as every compiler and standard sees them, sizes that do not match, and the in-place replacement.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{fs, iter};

use crate::support::{
    DEFAULT, Family, LARGEST, Library, Mode, OTHERS, Program, SMALLEST, STRICT, Sizes, c_tests, check, compiler,
    has_eigen, has_tool, out_dir, root, run, text,
};

const C_STANDARDS: [&str; 4] = ["c89", "c99", "c11", "c2x"];
const CPP_STANDARDS: [&str; 6] = ["c++98", "c++11", "c++14", "c++17", "c++20", "c++2b"];

const IN_PLACE: Program = Program::of("in_place", &["deltarobot/in_place.c"]).flags(&["-I.."]);
const IN_PLACE_HEADER_FIRST: Program =
    Program::of("in_place_header_first", &["deltarobot/in_place.c"]).flags(&["-I..", "-DWITH_HEADER_FIRST"]);
const IN_PLACE_CPP: Program = Program::of("in_place_cpp", &["deltarobot/in_place_cpp.cpp"]).flags(&["-I.."]);
const RELINKED: Program = Program::of("relinked", &["packaging/relinked.c"]);

/// Headers that are C++, and have no business in C or inside somebody's `extern "C"`.
pub(crate) const CPP_ONLY: [&str; 2] = [NEEDS_EIGEN, "libdeltarobot/protocol_pc_utils.h"];
const NEEDS_EIGEN: &str = "libdeltarobot/deltarobot.h";

/// The names of the library's headers, as programs include them.
pub(crate) fn headers(library: &Library) -> Vec<String> {
    let mut names = Vec::new();
    for dir in ["", "libdeltarobot/"] {
        let paths = fs::read_dir(library.include().join(dir)).unwrap().map(|entry| entry.unwrap().path());
        let files = paths.filter(|path| path.is_file());
        names.extend(files.map(|path| format!("{dir}{}", path.file_name().unwrap().to_str().unwrap())));
    }
    if !has_eigen() {
        names.retain(|name| name != NEEDS_EIGEN);
    }
    names.sort();
    assert!(names.iter().any(|name| name == "libdeltarobot/protocol.h"), "{names:?}");
    names
}

/// Programs that do nothing but include: each header alone and twice, and all of them.
fn sources(library: &Library, compiler: &str, cpp: bool) -> Vec<PathBuf> {
    let include = |name: &String| format!("#include \"{name}\"\n");
    let (cpp_only, names): (Vec<_>, Vec<_>) =
        headers(library).into_iter().partition(|name| CPP_ONLY.contains(&name.as_str()));
    let mut texts: Vec<_> = names.iter().map(|name| include(name).repeat(2)).collect();
    texts.push(names.iter().map(include).collect());
    texts.push(names.iter().rev().map(include).collect());
    if cpp {
        let inside: Vec<_> = texts.iter().map(|text| format!("extern \"C\" {{\n{text}}}\n")).collect();
        texts.extend(inside);
        texts.extend(cpp_only.iter().map(|name| include(name).repeat(2)));
    }
    let mut paths = Vec::new();
    for (number, text) in texts.iter().enumerate() {
        let extension = if cpp { "cpp" } else { "c" };
        let path = out_dir().join(format!("header-{}-{compiler}-{number}.{extension}", library.sizes));
        fs::write(&path, format!("{text}int main(void) {{ return 0; }}\n")).unwrap();
        paths.push(path);
    }
    paths
}

fn compiles_everywhere(name: &str, command: impl Fn() -> Command, cpp: bool) {
    let standards: &[&str] = if cpp { &CPP_STANDARDS } else { &C_STANDARDS };
    compiles(name, &command, cpp, DEFAULT, standards);
    // Other sizes are other numbers: the oldest standard is the strictest about these.
    compiles(name, &command, cpp, LARGEST, &standards[..1]);
}

fn compiles(name: &str, command: impl Fn() -> Command, cpp: bool, sizes: Sizes, standards: &[&str]) {
    let library = Library::of(sizes);
    for source in sources(&library, name, cpp) {
        for standard in standards {
            let mut command = command();
            command.arg(format!("-std={standard}")).args(STRICT).args(["-Wconversion", "-fsyntax-only"]);
            let output = run(command.arg("-I").arg(library.include()).arg(&source));
            let source = fs::read_to_string(&source).unwrap();
            assert!(output.status.success(), "{name} -std={standard}:\n{source}{}", text(&output));
        }
    }
}

#[test]
fn every_c_standard() {
    compiles_everywhere("cc", || compiler(false), false);
}

#[test]
fn every_cpp_standard() {
    compiles_everywhere("cxx", || compiler(true), true);
}

#[test]
fn every_c_standard_with_clang() {
    if has_tool("clang", "--version") {
        compiles_everywhere("clang", || Command::new("clang"), false);
    }
}

#[test]
fn every_cpp_standard_with_clang() {
    if has_tool("clang++", "--version") {
        compiles_everywhere("clang++", || Command::new("clang++"), true);
    }
}

/// The library would write behind the ends of packed structs: packing by an option or a pragma does not
/// compile.
#[test]
fn packed_structs_do_not_compile() {
    let library = Library::of(DEFAULT);
    let source = out_dir().join("packed.c");
    for header in headers(&library) {
        if CPP_ONLY.contains(&header.as_str()) || ["libdeltarobot/abi.h", "libdeltarobot/sizes.h"].contains(&&*header) {
            continue;
        }
        for (before, option, packs) in [
            ("", "-O1", false),
            ("", "-fpack-struct", true),
            ("#pragma pack(1)\n", "-O1", true),
            ("#pragma pack(4)\n", "-O1", true),
        ] {
            fs::write(&source, format!("{before}#include \"{header}\"\n")).unwrap();
            for (language, standard) in [("c", "c89"), ("c", "c2x"), ("c++", "c++98"), ("c++", "c++2b")] {
                for mut command in iter::once(compiler(language == "c++")).chain(like_msvc()) {
                    command.args(["-x", language, &format!("-std={standard}"), option, "-fsyntax-only", "-I"]);
                    let output = run(command.arg(library.include()).arg(&source));
                    let said = format!("{command:?} {before}: {}", text(&output));
                    assert_eq!(output.status.success(), !packs, "{said}");
                    assert_eq!(said.contains("structs_must_not_be_packed"), packs, "{said}");
                }
            }
        }
    }
}

/// Clang, if it is there, which takes itself for Microsoft's compiler, as far as that goes without Windows' headers.
fn like_msvc() -> Option<Command> {
    has_tool("clang", "--version").then(|| {
        let mut command = Command::new("clang");
        command.args(["--target=x86_64-pc-windows-msvc", "-U__clang__", "-ffreestanding"]);
        command
    })
}

#[test]
fn the_checked_in_sizes_are_the_default_ones() {
    let fresh = fs::read_to_string(Library::of(DEFAULT).include().join("libdeltarobot/sizes.h")).unwrap();
    let checked_in = fs::read_to_string(root().join("include/libdeltarobot/sizes.h")).unwrap_or_default();
    assert!(fresh == checked_in, "include/libdeltarobot/sizes.h is stale: run `make header`");
}

#[test]
fn every_size_is_varied() {
    let listed = fs::read_to_string(root().join("src/sizes.mk")).unwrap();
    let listed: Vec<_> = listed.lines().filter_map(|line| line.split_once(" ?= ")).collect();
    let own = DEFAULT.all().map(|(name, value)| (name, value.to_string()));
    assert!(listed.iter().copied().eq(own.iter().map(|(name, value)| (*name, value.as_str()))), "{listed:?}");
    for (index, size) in DEFAULT.all().iter().enumerate() {
        assert!(OTHERS.iter().any(|sizes| sizes.all()[index] != *size), "{size:?} is always the same");
    }
}

/// Compiles a program with the headers of the default sizes.
fn object_of(source: &str) -> PathBuf {
    let object = out_dir().join(format!("mismatch-{}.o", source.replace('/', "-")));
    let mut command = compiler(false);
    command.current_dir(c_tests()).args(["-std=c99", "-Icommon", "-I"]).arg(Library::of(DEFAULT).include());
    let output = run(command.args(["-c", source, "-o"]).arg(&object));
    assert!(output.status.success(), "{}", text(&output));
    object
}

/// What the linker says of an object and a library.
fn linked(object: &Path, library: &Library, shared: bool) -> (bool, String) {
    let mut command = compiler(false);
    command.arg(object).arg("-o").arg(out_dir().join(format!("mismatch-{}", library.sizes)));
    if shared {
        command.arg("-L").arg(&library.dir).arg("-ldeltarobot");
    } else {
        command.arg(library.archive());
    }
    let output = run(&mut command);
    (output.status.success(), text(&output))
}

fn links_only_to_a_library_of_its_sizes(family: Family, source: &str, suffix: &str, functions: &[&str]) {
    let object = object_of(source);
    for sizes in [DEFAULT, Sizes::new(256, 32), SMALLEST, LARGEST] {
        let library = Library::of(sizes);
        for shared in [false, true] {
            let (links, said) = linked(&object, &library, shared);
            assert_eq!(links, !sizes.are_others_for(family), "{source} to {sizes}, shared: {shared}: {said}");
            for function in functions {
                let symbol = format!("{function}{suffix}'");
                assert!(links || said.contains(&symbol), "{symbol} is not missed:\n{said}");
            }
        }
    }
}

#[test]
fn a_library_of_other_sizes_does_not_link() {
    let functions = ["dp_process", "dp_recv", "dp_process_each", "dp_recv_idle", "dp_init"];
    links_only_to_a_library_of_its_sizes(Family::Deltarobot, "deltarobot/ext.c", "_128_32", &functions);
}

#[test]
fn a_library_of_other_line_sizes_does_not_link() {
    let functions = ["olp_host_init", "olp_host_poll", "olp_device_init", "olp_device_poll"];
    links_only_to_a_library_of_its_sizes(Family::Line, "line/channel.c", "_255_8_128_16", &functions);
}

#[test]
fn a_library_of_other_gx_sizes_does_not_link() {
    let functions = ["gx_host_init", "gx_host_poll", "gx_motion_init", "gx_motion_next"];
    links_only_to_a_library_of_its_sizes(Family::Gx, "gx/channel.c", "_16_16", &functions);
}

/// Compiles a program that defines a size of its own before the protocol's header.
fn with_size(name: &str, value: usize) -> (bool, String) {
    let header = match name.split('_').next() {
        Some("OLP") => "line_device.h",
        Some("GX") => "gx_motion.h",
        _ => "protocol_ext.h",
    };
    let define = format!("{name}={value}");
    let source = out_dir().join(format!("{define}.c"));
    fs::write(&source, format!("#include \"libdeltarobot/{header}\"\nint main(void) {{ return 0; }}\n")).unwrap();
    let mut command = compiler(false);
    command.arg(format!("-D{define}")).arg("-fsyntax-only").arg("-I").arg(Library::of(DEFAULT).include());
    let output = run(command.arg(source));
    (output.status.success(), text(&output))
}

#[test]
fn a_size_of_the_programs_own_does_not_compile() {
    for (name, built_with) in DEFAULT.all() {
        for own in [built_with / 2, built_with + 1] {
            let (compiles, said) = with_size(name, own);
            assert!(!compiles, "{name}={own} compiles");
            assert!(said.contains("#error") && said.contains(&format!("{name}={built_with}:")), "{said}");
        }
    }
}

#[test]
fn the_librarys_own_size_may_be_defined() {
    for (name, built_with) in DEFAULT.all() {
        let (compiles, said) = with_size(name, built_with);
        assert!(compiles, "{said}");
    }
}

#[test]
fn impossible_sizes_are_not_built() {
    let lines = "OLP_LINE_MAX must be between 63, the longest command, and 32000";
    let windows = "OLP_WINDOW_MAX must be between 1 and 64";
    let replies = "OLP_REPLY_MAX must be between 64 and 255";
    let devices = "OLP_DEVICES_MAX must be between 1 and 255";
    let (queues, moves) = ("GX_QUEUE_MAX must be between 1 and 255", "GX_WINDOW_MAX must be between 1 and 255");
    let others = [lines, windows, replies, devices, queues, moves];
    for (sizes, because) in [
        (Sizes::new(128, 0), &["DP_DATA_MAX_SIZE must be between 1 and 255"][..]),
        (Sizes::new(512, 256), &["DP_DATA_MAX_SIZE must be between 1 and 255"]),
        (Sizes::new(36, 32), &["DP_BUFSIZE is too small"]),
        (Sizes::new(0, 32), &["DP_BUFSIZE is too small"]),
        (Sizes::new(1 << 31, 32), &["DP_BUFSIZE is too large"]),
        (DEFAULT.olp([62, 0, 63, 0]).gx([0, 0]), &others),
        (DEFAULT.olp([32001, 65, 256, 256]).gx([256, 256]), &others),
    ] {
        let said = Library::refusal(sizes);
        for because in because {
            assert!(said.contains(because), "{sizes}: {said}");
        }
    }
}

#[test]
fn the_source_file_compiles_to_nothing() {
    let library = Library::of(DEFAULT);
    for standard in ["c89", "c2x"] {
        let object = out_dir().join(format!("protocol-{standard}.o"));
        let mut command = compiler(false);
        command.arg(format!("-std={standard}")).arg("-I").arg(library.include());
        let output = run(command.arg("-c").arg(root().join("src/protocol.c")).arg("-o").arg(&object));
        assert!(output.status.success(), "{}", text(&output));
        let symbols = run(Command::new("nm").arg(object));
        assert_eq!(String::from_utf8_lossy(&symbols.stdout), "");
    }
}

#[test]
fn the_source_file_is_included_in_c() {
    check::<&str>(&IN_PLACE, DEFAULT, Mode::Static, &[]);
    check::<&str>(&IN_PLACE_HEADER_FIRST, DEFAULT, Mode::Static, &[]);
}

#[test]
fn the_source_file_is_included_in_cpp() {
    check::<&str>(&IN_PLACE_CPP, DEFAULT, Mode::Static, &[]);
}

#[test]
fn objects_compiled_with_the_originals_header_link() {
    check::<&str>(&RELINKED, DEFAULT, Mode::Static, &[]);
    check::<&str>(&RELINKED, DEFAULT, Mode::Shared, &[]);
}
