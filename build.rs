//! Fixes the sizes: as constants for Rust, in the C header of sizes, and in the names of the symbols to export.
//!
//! Reads from the environment: the sizes that `src/sizes.mk` lists, and `DP_SIZES_DIR`, the directory that shall receive
//! `sizes.h`, `exports.txt` and what LLVM reads of these (`make` sets it; without it they stay in cargo's `OUT_DIR`).

use std::{env, error::Error, fmt::Write, fs, path::Path};

/// Prefixes of sizes, and of the functions that rest on them.
const FAMILIES: [&str; 3] = ["DP", "OLP", "GX"];

fn main() -> Result<(), Box<dyn Error>> {
    let sizes = sizes()?;
    let out = env::var("OUT_DIR")?;

    let mut constants = String::new();
    for size in &sizes {
        writeln!(constants, "/// {}\npub const {}: usize = {};", size.meaning, size.name, size.value)?;
    }
    fs::write(Path::new(&out).join("sizes.rs"), constants)?;
    for family in FAMILIES {
        println!("cargo::rustc-env={family}_SIZES={}", suffix(&sizes, family));
    }

    println!("cargo::rerun-if-env-changed=DP_SIZES_DIR");
    println!("cargo::rerun-if-changed=src");
    let dir = env::var("DP_SIZES_DIR").unwrap_or(out);
    fs::create_dir_all(&dir)?;
    let mut symbols = Vec::new();
    find_exports(Path::new("src"), &sizes, &mut symbols)?;
    symbols.sort();
    let (mut exports, mut attributes) = (String::new(), String::new());
    for symbol in symbols {
        writeln!(exports, "{symbol}")?;
        if !symbol.starts_with("dp_serial_") {
            writeln!(attributes, "{symbol},frame-pointer=none")?;
        }
    }
    for (name, text) in
        [("sizes.h", sizes_header(&sizes)?), ("exports.txt", exports), ("no_frame_pointers.csv", attributes)]
    {
        // One that is as it should be is left alone, for the sake of those who make things depend on it.
        let path = Path::new(&dir).join(name);
        if !fs::read(&path).is_ok_and(|old| old == text.as_bytes()) {
            fs::write(path, text)?;
        }
    }
    Ok(())
}

/// Finds the functions marked `#[export]` below a directory, and lists the one or two symbols that each has.
fn find_exports(directory: &Path, sizes: &[Size], symbols: &mut Vec<String>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(directory)? {
        let path = entry?.path();
        if path.is_dir() {
            find_exports(&path, sizes, symbols)?;
        }
        // Emacs marks a file that is being edited by a link to nothing.
        if !path.is_file() || path.extension().is_none_or(|extension| extension != "rs") {
            continue;
        }
        for piece in fs::read_to_string(path)?.split("\n#[export").skip(1) {
            let (family, function) = piece.split_once(']').ok_or("#[export without an end")?;
            let (_, function) = function.split_once(" fn ").ok_or("#[export] without a function")?;
            let name = function.split('(').next().unwrap_or_default();
            symbols.push(name.into());
            if !family.is_empty() {
                symbols.push(format!("{name}_{}", suffix(sizes, &family.trim_matches(['(', ')']).to_uppercase())));
            }
        }
    }
    Ok(())
}

/// A size that is fixed when the library is built.
struct Size {
    name: String,
    value: u32,
    meaning: String,
}

/// The sizes of `src/sizes.mk`, as the environment asks for them: decimal numbers. `src/sizes.rs` checks their ranges.
fn sizes() -> Result<Vec<Size>, Box<dyn Error>> {
    let (mut sizes, mut meaning) = (Vec::new(), String::new());
    for line in fs::read_to_string("src/sizes.mk")?.lines() {
        if let Some((name, default)) = line.split_once(" ?= ") {
            println!("cargo::rerun-if-env-changed={name}");
            let asked = env::var(name).unwrap_or_else(|_| default.into());
            let value = asked.trim().parse().map_err(|_| format!("{name}={asked}: not a whole number"))?;
            sizes.push(Size { name: name.into(), value, meaning: format!("{meaning}By default {default}.") });
        }
        meaning = line.strip_prefix("# ").map_or_else(String::new, |text| format!("{text} "));
    }
    Ok(sizes)
}

/// The sizes of a family as they stand in the names of symbols: `128_32`.
fn suffix(sizes: &[Size], family: &str) -> String {
    let sizes = sizes.iter().filter(|size| size.name.starts_with(family));
    sizes.map(|size| size.value.to_string()).collect::<Vec<_>>().join("_")
}

/// The text of `libdeltarobot/sizes.h`.
fn sizes_header(sizes: &[Size]) -> Result<String, Box<dyn Error>> {
    let mut text = String::from(
        "/**
 * @file
 * libdeltarobot/sizes.h: the sizes that the library was built for. They are part of the structs' layout and of the
 * symbols' names, so a program cannot choose its own: it may define the same ones, before it includes a header.
 *
 * Generated from src/sizes.mk: `make header` renews it; a build for other sizes has its own. A build in the source tree
 * leaves its own in sizes_in_place.h, for programs that include the headers where they lie.
 */
#if !defined(LIBDELTAROBOT_SIZES_H) && !defined(LIBDELTAROBOT_SIZES_IN_PLACE)
#define LIBDELTAROBOT_SIZES_IN_PLACE
#ifdef __has_include
#if __has_include(\"sizes_in_place.h\")
#include \"sizes_in_place.h\"
#endif
#endif
#endif
#ifndef LIBDELTAROBOT_SIZES_H
#define LIBDELTAROBOT_SIZES_H
",
    );
    for Size { name, value, meaning } in sizes {
        write!(
            text,
            "
#if defined({name}) && ({name}) != {value}
#error \"libdeltarobot was built with {name}={value}: build it again with the size that this program defines\"
#endif
#undef {name}
/** {meaning} */
#define {name} {value}
"
        )?;
    }
    text += "\n#endif\n";
    Ok(text)
}
