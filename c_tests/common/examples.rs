//! The examples in the headers: each function has one, and all of them compile.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::headers::{CPP_ONLY, headers};
use crate::support::{DEFAULT, Language, Library, STRICT, c_tests, compiler, has_tool, out_dir, root, run, text};

/// What an example may do and a program should not: leave things unused. `= {0}` is how C sets a struct to zero, but
/// C++ compilers would rather see `= {}`.
const TOLERANT: [&str; 3] = ["-Wno-unused", "-Wno-unused-parameter", "-Wno-missing-field-initializers"];

/// Headers that only the others include.
const WITHOUT_FUNCTIONS: [&str; 2] = ["libdeltarobot/abi.h", "libdeltarobot/sizes.h"];

/// The headers' names, as programs include them, and their texts.
fn texts() -> Vec<(String, String)> {
    let library = Library::of(DEFAULT);
    let text = |name: String| {
        let text = fs::read_to_string(library.include().join(&name)).unwrap();
        (name, text)
    };
    headers(&library).into_iter().filter(|name| !WITHOUT_FUNCTIONS.contains(&name.as_str())).map(text).collect()
}

/// A comment of a header, and what is declared behind it.
#[derive(Debug, Default)]
struct Item {
    /// Where the comment begins, counted from 1.
    line: usize,
    comment: String,
    /// Nothing when it is no declaration of a function or a type of functions.
    declaration: String,
}

impl Item {
    /// The function declared, if it is one.
    fn function(&self) -> Option<&str> {
        let head = self.declaration.split('(').next()?;
        if self.is_type() || head.len() == self.declaration.len() {
            return None;
        }
        let name = head.trim_end().rsplit(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_').next()?;
        // Macros that stand for declarations have none.
        (name != name.to_uppercase()).then_some(name)
    }

    fn is_type(&self) -> bool {
        self.declaration.starts_with("typedef")
    }

    /// Its examples, which are indented, and the lines they begin at.
    fn examples(&self) -> Vec<(usize, String)> {
        let mut examples: Vec<(usize, String)> = Vec::new();
        let mut inside = false;
        for (line, text) in (self.line..).zip(self.comment.lines()) {
            let text = text.trim_start().trim_start_matches('*');
            let code = text.strip_prefix("     ");
            if code.is_some() && !inside {
                examples.push((line, String::new()));
            }
            // Empty lines between lines of code belong to it.
            inside = code.is_some() || inside && text.is_empty();
            if inside {
                writeln!(examples.last_mut().unwrap().1, "{}", code.unwrap_or_default()).unwrap();
            }
        }
        examples
    }
}

/// The comments and declarations of a header. It needs no more of C than headers have.
fn items(header: &str) -> Vec<Item> {
    let mut items: Vec<Item> = Vec::new();
    let (mut at, mut depth) = (0, 0_usize);
    // Whether a declaration that ends now belongs to the last comment, and what there is of it.
    let (mut follows, mut declaration) = (false, String::new());
    while let Some(first) = header[at..].chars().next() {
        let rest = &header[at..];
        let mut length = first.len_utf8();
        if rest.starts_with("/*") {
            length = rest.find("*/").map_or(rest.len(), |end| end + 2);
            if declaration.trim().is_empty() {
                let line = header[..at].lines().count() + usize::from(header[..at].ends_with('\n') || at == 0);
                items.push(Item { line, comment: rest[..length].into(), declaration: String::new() });
                follows = depth == 0;
            }
        } else if first == '#' {
            length = rest.replace("\\\n", "\\ ").find('\n').unwrap_or(rest.len());
            follows = false;
        } else if first == '}' {
            depth = depth.saturating_sub(1);
        } else if depth > 0 {
            depth += usize::from(first == '{');
        } else if first == '{' || first == ';' {
            let ended = std::mem::take(&mut declaration);
            let ended = ended.trim();
            let is_a_scope = first == '{' && (ended == "extern \"C\"" || ended.starts_with("namespace"));
            depth = usize::from(first == '{' && !is_a_scope);
            if ended.contains('(') {
                if !follows {
                    items.push(Item::default());
                }
                items.last_mut().unwrap().declaration = ended.into();
            }
            follows = false;
        } else {
            declaration.push(first);
        }
        at += length;
    }
    items
}

#[test]
fn undocumented_functions_are_seen() {
    let header = "/**\n * Does.\n *\n *     if (f(1))\n *\n *         g();\n */\nint f(int a)\nSIZED(\"f\");\n\
                  #ifdef __cplusplus\nextern \"C\" {\n#endif\nconst char *g(void);\nstruct s { int (*h)(void); };\n\
                  /* Of a type. */\ntypedef int (*t)(void *usr);\ninline void k()\n{\n    f(1);\n}\n#define l(x) f(x)\n}\n";
    let items = items(header);
    let functions: Vec<_> =
        items.iter().filter_map(|item| Some((item.function()?, !item.examples().is_empty()))).collect();
    assert_eq!(functions, [("f", true), ("g", false), ("k", false)]);
    assert_eq!(items[0].examples(), [(4, "if (f(1))\n\n    g();\n".into())]);
    assert!(items.iter().any(|item| item.is_type() && item.line == 15), "{items:?}");
}

#[test]
fn each_function_has_an_example() {
    let mut missing = String::new();
    for (name, header) in texts() {
        let items = items(&header);
        let has_something = items.iter().any(|item| item.function().is_some() || !item.examples().is_empty());
        assert!(has_something, "{name} has no functions and no examples");
        for item in items.iter().filter(|item| item.examples().is_empty()) {
            if let Some(function) = item.function() {
                writeln!(missing, "{name}: {function}").unwrap();
            }
        }
    }
    assert!(missing.is_empty(), "without an example:\n{missing}");
}

/// A header's examples, each in a function of its own; those of function types, which are such functions, as they are.
fn unit(name: &str, header: &str) -> String {
    let mut unit = format!("#include \"{name}\"\n#include \"examples_prelude.h\"\n");
    for item in items(header) {
        for (line, example) in item.examples() {
            if item.is_type() {
                write!(unit, "#line {line} \"{name}\"\n{example}").unwrap();
            } else {
                let signature = format!("void example_{line}(void)");
                write!(unit, "{signature};\n{signature}\n{{\n#line {line} \"{name}\"\n{example}}}\n").unwrap();
            }
        }
    }
    unit
}

fn compiles(unit: &Path, mut command: Command, standard: &str) {
    command.arg(format!("-std={standard}")).args(STRICT).args(TOLERANT).arg("-I").arg(c_tests().join("common"));
    command.arg("-I").arg(Library::of(DEFAULT).include()).arg("-c").arg(unit);
    let output = run(command.arg("-o").arg(unit.with_extension("o")));
    assert!(output.status.success(), "{command:?}:\n{}", text(&output));
}

fn all_compile(name: &str, command: impl Fn() -> Command, language: Language) {
    let (cpp, standard) = (language.is_cpp(), if language.is_cpp() { "c++98" } else { "c99" });
    let dir = out_dir().join(format!("examples-{name}"));
    fs::create_dir_all(&dir).unwrap();
    for (header, text) in texts() {
        if !cpp && CPP_ONLY.contains(&header.as_str()) {
            continue;
        }
        let path = dir.join(header.replace('/', "-")).with_extension(if cpp { "cpp" } else { "c" });
        fs::write(&path, unit(&header, &text)).unwrap();
        compiles(&path, command(), standard);
    }
}

#[test]
fn all_compile_as_c() {
    all_compile("cc", || compiler(false), Language::C99);
}

#[test]
fn all_compile_as_cpp() {
    all_compile("cxx", || compiler(true), Language::Cpp98);
}

#[test]
fn all_compile_as_c_with_clang() {
    if has_tool("clang", "--version") {
        all_compile("clang", || Command::new("clang"), Language::C99);
    }
}

#[test]
fn all_compile_as_cpp_with_clang() {
    if has_tool("clang++", "--version") {
        all_compile("clangxx", || Command::new("clang++"), Language::Cpp98);
    }
}

#[test]
fn lines_fit_a_screen() {
    for (name, header) in texts() {
        for (number, line) in (1..).zip(header.lines()) {
            assert!(line.chars().count() <= 120, "{name}:{number} is too long");
        }
    }
}

/// README's program, as it stands there.
#[test]
fn the_readmes_program_receives_a_message() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let (_, rest) = readme.split_once("```c\n").unwrap();
    let source = out_dir().join("readme.c");
    fs::write(&source, rest.split_once("```").unwrap().0).unwrap();
    let library = Library::of(DEFAULT);
    let program = out_dir().join("readme");
    let mut compile = compiler(false);
    compile
        .arg("-std=c99")
        .arg("-I")
        .arg(library.include())
        .arg(&source)
        .arg(library.archive())
        .arg("-o")
        .arg(&program);
    let output = run(&mut compile);
    assert!(output.status.success(), "{}", text(&output));
    let output = run(Command::new("sh").arg("-c").arg("printf 'noise$A\\001M\\355:' | \"$0\"").arg(&program));
    assert_eq!(text(&output), "A with 1 bytes\n");
}
