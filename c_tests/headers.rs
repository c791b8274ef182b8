//! The headers as every compiler and standard sees them, sizes that do not match, and the in-place replacement.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::support::{
    DEFAULT, Language, Library, Mode, Program, STRICT, Sizes, c_tests, check, compiler, has_tool, out_dir, root, run,
    text,
};

const C_STANDARDS: [&str; 4] = ["c89", "c99", "c11", "c2x"];
const CPP_STANDARDS: [&str; 6] = ["c++98", "c++11", "c++14", "c++17", "c++20", "c++2b"];

const IN_PLACE: Program = Program::c99("in_place", &["in_place.c"]).flags(&["-I.."]);
const IN_PLACE_HEADER_FIRST: Program =
    Program::c99("in_place_header_first", &["in_place.c"]).flags(&["-I..", "-DWITH_HEADER_FIRST"]);
const IN_PLACE_CPP: Program =
    Program::c99("in_place_cpp", &["in_place_cpp.cpp"]).language(Language::Cpp98).flags(&["-I.."]);
const RELINKED: Program = Program::c99("relinked", &["relinked.c"]);

/// Headers that are C++, and have no business in C or inside somebody's `extern "C"`.
const CPP_ONLY: [&str; 1] = ["protocol_pc_utils.h"];

/// The names of the library's headers.
fn headers(library: &Library) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(library.include().join("libdeltarobot"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert!(names.iter().any(|name| name == "protocol.h"), "{names:?}");
    names
}

/// Programs that do nothing but include: each header alone and twice, and all of them.
fn sources(library: &Library, compiler: &str, cpp: bool) -> Vec<PathBuf> {
    let include = |name: &String| format!("#include \"libdeltarobot/{name}\"\n");
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
        fs::write(&path, format!("{text}int main(void) {{ return DP_RC_SUCCESS; }}\n")).unwrap();
        paths.push(path);
    }
    paths
}

fn compiles_everywhere(name: &str, command: impl Fn() -> Command, cpp: bool, sizes: Sizes) {
    let library = Library::of(sizes);
    let standards: &[&str] = if cpp { &CPP_STANDARDS } else { &C_STANDARDS };
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
    compiles_everywhere("cc", || compiler(false), false, DEFAULT);
    compiles_everywhere("cc", || compiler(false), false, Sizes::new(512, 255));
}

#[test]
fn every_cpp_standard() {
    compiles_everywhere("cxx", || compiler(true), true, DEFAULT);
    compiles_everywhere("cxx", || compiler(true), true, Sizes::new(512, 255));
}

#[test]
fn every_c_standard_with_clang() {
    if has_tool("clang", "--version") {
        compiles_everywhere("clang", || Command::new("clang"), false, DEFAULT);
    }
}

#[test]
fn every_cpp_standard_with_clang() {
    if has_tool("clang++", "--version") {
        compiles_everywhere("clang++", || Command::new("clang++"), true, DEFAULT);
    }
}

#[test]
fn the_checked_in_headers_are_fresh() {
    let library = Library::of(DEFAULT);
    for name in headers(&library) {
        let fresh = fs::read_to_string(library.include().join("libdeltarobot").join(&name)).unwrap();
        let checked_in = fs::read_to_string(root().join("include/libdeltarobot").join(&name)).unwrap_or_default();
        assert!(fresh == checked_in, "include/libdeltarobot/{name} is stale: run `make header`");
    }
}

/// Compiles a program which uses all of the library with the headers of one size.
fn object_for(sizes: Sizes) -> PathBuf {
    let library = Library::of(sizes);
    let object = out_dir().join(format!("mismatch-{sizes}.o"));
    let mut command = compiler(false);
    command.current_dir(c_tests()).args(["-std=c99", "-I.", "-I"]).arg(library.include());
    let output = run(command.args(["-c", "ext.c", "-o"]).arg(&object));
    assert!(output.status.success(), "{}", text(&output));
    object
}

#[test]
fn a_library_of_other_sizes_does_not_link() {
    let object = object_for(DEFAULT);
    for sizes in [Sizes::new(256, 32), Sizes::new(512, 255)] {
        let library = Library::of(sizes);
        let executable = out_dir().join(format!("mismatch-{sizes}"));
        for shared in [false, true] {
            let mut command = compiler(false);
            command.arg(&object).arg("-o").arg(&executable);
            if shared {
                command.arg("-L").arg(&library.dir).arg("-ldeltarobot");
            } else {
                command.arg(library.archive());
            }
            let output = run(&mut command);
            assert!(!output.status.success(), "linked to {sizes}, shared: {shared}");
            for function in ["dp_process", "dp_recv", "dp_process_each", "dp_recv_idle", "dp_init"] {
                let symbol = format!("{function}_128_32'");
                assert!(text(&output).contains(&symbol), "{symbol} is not missed:\n{}", text(&output));
            }
        }
    }
}

/// Compiles a program that defines a size of its own before the header.
fn with_size(define: &str) -> (bool, String) {
    let library = Library::of(DEFAULT);
    let source = out_dir().join(format!("{define}.c"));
    fs::write(&source, "#include \"libdeltarobot/protocol_ext.h\"\nint main(void) { return 0; }\n").unwrap();
    let mut command = compiler(false);
    let output =
        run(command.arg(format!("-D{define}")).arg("-fsyntax-only").arg("-I").arg(library.include()).arg(source));
    (output.status.success(), text(&output))
}

#[test]
fn a_size_of_the_programs_own_does_not_compile() {
    for (define, built_with) in [("DP_DATA_MAX_SIZE=64", "DP_DATA_MAX_SIZE=32"), ("DP_BUFSIZE=512", "DP_BUFSIZE=128")] {
        let (compiles, said) = with_size(define);
        assert!(!compiles, "{define} compiles");
        assert!(said.contains("#error") && said.contains(built_with), "{said}");
    }
}

#[test]
fn the_librarys_own_size_may_be_defined() {
    for define in ["DP_DATA_MAX_SIZE=32", "DP_BUFSIZE=128"] {
        let (compiles, said) = with_size(define);
        assert!(compiles, "{said}");
    }
}

#[test]
fn impossible_sizes_are_not_built() {
    for (sizes, because) in [
        (Sizes::new(128, 0), "DP_DATA_MAX_SIZE must be between 1 and 255"),
        (Sizes::new(512, 256), "DP_DATA_MAX_SIZE must be between 1 and 255"),
        (Sizes::new(36, 32), "DP_BUFSIZE is too small"),
        (Sizes::new(0, 32), "DP_BUFSIZE is too small"),
        (Sizes::new(1 << 31, 32), "DP_BUFSIZE is too large"),
    ] {
        let said = Library::refusal(sizes);
        assert!(said.contains(because), "{sizes}: {said}");
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
