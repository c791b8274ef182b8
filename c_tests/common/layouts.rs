//! The layouts that `src/layouts.rs` lists and Rust asserts, asserted of the headers in C and in C++.

use std::collections::HashSet;
use std::fmt::Write;
use std::fs;

use crate::headers::{CPP_ONLY, headers};
use crate::support::{DEFAULT, LARGEST, Library, SMALLEST, Sizes, compiler, out_dir, root, run, text};

/// The list: what C calls a struct, and its fields as C declares them.
fn listed() -> Vec<(String, Vec<(String, String)>)> {
    let source = fs::read_to_string(root().join("src/layouts.rs")).unwrap();
    let (_, list) = source.split_once("\nlayouts! {").unwrap();
    let structs: Vec<(&str, &str)> = list.split('}').filter_map(|item| item.split_once('{')).collect();
    let in_c: Vec<(&str, &str)> = structs
        .iter()
        .map(|(head, _)| head.rsplit_once('=').unwrap())
        .map(|(c, rust)| (c.trim().rsplit(['\n', ' ']).next().unwrap(), rust.trim()))
        .collect();
    let declared = |field: &str| {
        let (name, of_type) = field.split_once(':').unwrap();
        let name = name.trim().trim_start_matches("r#");
        (name.to_owned(), declaration(name, of_type.trim(), &in_c))
    };
    let fields =
        |fields: &str| fields.split(", ").map(|field| field.trim().trim_end_matches(',')).map(declared).collect();
    let normal = |fields: &str| fields.split_whitespace().collect::<Vec<_>>().join(" ");
    in_c.iter().zip(&structs).map(|((c, _), (_, list))| ((*c).to_owned(), fields(&normal(list)))).collect()
}

/// A field of this type in C.
fn declaration(name: &str, of_type: &str, structs: &[(&str, &str)]) -> String {
    if let Some((element, count)) =
        of_type.strip_prefix('[').and_then(|rest| rest.trim_end_matches(']').split_once("; "))
    {
        return declaration(&format!("{name}[{count}]"), element, structs);
    }
    if let Some(target) = of_type.strip_prefix("*const ") {
        return declaration(&format!("*{name}"), target, structs);
    }
    let in_c = match of_type {
        "c_char" => "char",
        "c_uchar" | "u8" => "unsigned char",
        "u16" => "unsigned short",
        "c_int" | "i32" => "int",
        "c_uint" => "unsigned int",
        "c_long" => "long",
        "c_ulong" => "unsigned long",
        "c_float" => "float",
        "Function" => return format!("void (*{name})(void)"),
        _ => {
            let (in_c, _) = structs.iter().find(|(_, rust)| *rust == of_type).unwrap_or_else(|| panic!("{of_type}?"));
            return format!("struct {in_c} {name}");
        }
    };
    format!("{in_c} {name}")
}

fn are_as_listed(sizes: Sizes, cpp: bool) {
    let library = Library::of(sizes);
    let mut source = String::from("#include <stddef.h>\n");
    for header in headers(&library).iter().filter(|header| !CPP_ONLY.contains(&header.as_str())) {
        writeln!(source, "#include \"{header}\"").unwrap();
    }
    for (number, (name, fields)) in listed().iter().enumerate() {
        // The posted header has no tags.
        let name = if name.starts_with("CP") { name.clone() } else { format!("struct {name}") };
        writeln!(source, "struct listed_{number} {{").unwrap();
        for (_, declaration) in fields {
            writeln!(source, "    {declaration};").unwrap();
        }
        writeln!(source, "}};\ntypedef char size_{number}[sizeof({name}) == sizeof(struct listed_{number}) ? 1 : -1];")
            .unwrap();
        for (field, _) in fields {
            let offsets = format!("offsetof({name}, {field}) == offsetof(struct listed_{number}, {field})");
            writeln!(source, "typedef char {field}_{number}[{offsets} ? 1 : -1];").unwrap();
        }
    }
    let path = out_dir().join(format!("layouts-{sizes}.{}", if cpp { "cpp" } else { "c" }));
    fs::write(&path, source).unwrap();
    let mut command = compiler(cpp);
    command.arg(if cpp { "-std=c++98" } else { "-std=c11" }).arg("-fsyntax-only").arg("-I").arg(library.include());
    let output = run(command.arg(path));
    assert!(output.status.success(), "{}", text(&output));
}

#[test]
fn are_as_listed_in_c() {
    for sizes in [DEFAULT, SMALLEST, LARGEST] {
        are_as_listed(sizes, false);
    }
}

#[test]
fn are_as_listed_in_cpp() {
    for sizes in [DEFAULT, SMALLEST, LARGEST] {
        are_as_listed(sizes, true);
    }
}

/// Every struct of a header is listed, or opaque.
#[test]
fn all_are_listed() {
    let library = Library::of(DEFAULT);
    let listed: HashSet<String> = listed().into_iter().map(|(name, _)| name).collect();
    let mut missing = Vec::new();
    for header in headers(&library).iter().filter(|header| !CPP_ONLY.contains(&header.as_str())) {
        let header = fs::read_to_string(library.include().join(header)).unwrap();
        for item in header.split("\nstruct ").skip(1) {
            let (name, body) = item.split_once(' ').unwrap();
            let is_opaque = body.lines().nth(1).is_some_and(|line| line.contains(" opaque["));
            if body.starts_with("{\n") && !is_opaque && !listed.contains(name) {
                missing.push(name.to_owned());
            }
        }
    }
    assert_eq!(missing, <[String; 0]>::default(), "add them to src/layouts.rs");
}
