//! Fixes the sizes and generates the C headers for them.
//!
//! Reads from the environment: the sizes that `src/sizes.mk` lists, and `DP_HEADER_DIR`, the directory that shall
//! receive the headers and `exports.txt`, the symbols to export (`make` sets it; without it they stay in cargo's
//! `OUT_DIR`).

use std::{env, error::Error, fmt::Write, fs, path::Path};

/// Prefixes of sizes, and of the functions that rest on them.
const FAMILIES: [&str; 3] = ["DP", "OLP", "GX"];

/// The headers: each is generated from a module, `src/MODULE.rs` (and the further files named here, for types whose
/// layout it shows), with the settings in `src/MODULE.toml`.
const HEADERS: [(&str, &str, &[&str]); 13] = [
    ("libdeltarobot/protocol.h", "protocol", &["crates/protocols/src/deltarobot/ring.rs"]),
    ("libdeltarobot/protocol_ext.h", "protocol_ext", &[]),
    (
        "libdeltarobot/payload.h",
        "payload",
        &["src/payload/building.rs", "src/payload/reading.rs", "src/payload/text.rs"],
    ),
    ("libdeltarobot/host.h", "host", &["src/host/event.rs"]),
    ("libdeltarobot/controller.h", "controller", &[]),
    ("libdeltarobot/serial.h", "serial", &[]),
    (
        "libdeltarobot/line_protocol.h",
        "line_protocol",
        &[
            "src/line_protocol/checksum.rs",
            "src/line_protocol/message.rs",
            "src/line_protocol/value.rs",
            "src/line_protocol/encoder.rs",
            "src/line_protocol/receiver.rs",
            "crates/protocols/src/line/receiver.rs",
        ],
    ),
    (
        "libdeltarobot/line_host.h",
        "line_host",
        &[
            "src/line_host/event.rs",
            "crates/protocols/src/line/host.rs",
            "crates/protocols/src/line/host/counter.rs",
            "crates/protocols/src/line/host/table.rs",
            "crates/protocols/src/line/host/health.rs",
            "crates/protocols/src/line/host/settings.rs",
            "crates/protocols/src/line/host/slot.rs",
        ],
    ),
    (
        "libdeltarobot/line_device.h",
        "line_device",
        &[
            "crates/protocols/src/line/device.rs",
            "crates/protocols/src/line/device/answers.rs",
            "crates/protocols/src/line/device/health.rs",
            "crates/protocols/src/line/device/input.rs",
            "crates/protocols/src/line/device/setup.rs",
        ],
    ),
    ("libdeltarobot/gx.h", "gx", &["src/gx/write.rs", "src/gx/contour.rs"]),
    ("libdeltarobot/gx_host.h", "gx_host", &[]),
    ("libdeltarobot/gx_motion.h", "gx_motion", &[]),
    ("ContouringProtocol.h", "contouring_protocol", &[]),
];

/// What the heads of those with a clock say besides.
const TIMES: &str =
    "- Times (now_ms) are milliseconds of any clock that doesn't go back. Their lowest 32 bits count, and may wrap.";

/// What the head of each header says about all of its functions.
const RULES: &str = "\
What holds for each function, unless it says otherwise (docs/api.md has all of it):
 *
 * - Pointers: NULL is answered with an error, never followed. Others point to whole objects of their type, aligned,
 *   writable where they are not const, with any contents. The objects of one call don't overlap.
 * - Threads and interrupts: a call has its objects to itself; no other thread and no interrupt touches them while it
 *   runs. Calls on different objects may come at the same time, in interrupts too. No call waits or locks.
 * - Callbacks may call the library, on the same objects too.";

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

    println!("cargo::rerun-if-env-changed=DP_HEADER_DIR");
    println!("cargo::rerun-if-changed=src");
    let dir = env::var("DP_HEADER_DIR").unwrap_or_else(|_| format!("{out}/include"));
    fs::create_dir_all(Path::new(&dir).join("libdeltarobot"))?;
    for (path, module, types) in HEADERS {
        write_if_new(&Path::new(&dir).join(path), &header(path, module, types, &sizes)?)?;
    }
    write_if_new(&Path::new(&dir).join("exports.txt"), &exports(&sizes)?)?;
    Ok(())
}

/// A size that is fixed when the library is built.
struct Size {
    name: String,
    value: u32,
    meaning: String,
}

/// The sizes of `src/sizes.mk`, as the environment asks for them: decimal numbers. Their ranges are `src/config.rs`'s
/// business.
fn sizes() -> Result<Vec<Size>, Box<dyn Error>> {
    let text = fs::read_to_string(format!("{}/src/sizes.mk", env::var("CARGO_MANIFEST_DIR")?))?;
    let mut sizes = Vec::new();
    let mut meaning = String::new();
    for line in text.lines() {
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
    let values: Vec<_> =
        sizes.iter().filter(|size| size.name.starts_with(family)).map(|size| size.value.to_string()).collect();
    values.join("_")
}

/// The symbols that `src/exports.txt` lists, for these sizes.
fn exports(sizes: &[Size]) -> Result<String, Box<dyn Error>> {
    let list = fs::read_to_string(format!("{}/src/exports.txt", env::var("CARGO_MANIFEST_DIR")?))?;
    let mut symbols = String::new();
    for name in list.lines() {
        let family = name.split('_').next().unwrap_or_default().to_uppercase();
        writeln!(symbols, "{}", name.replace("@SIZES@", &suffix(sizes, &family)))?;
    }
    Ok(symbols)
}

/// What the first header of a family says about its sizes.
fn sizes_block(sizes: &[Size], family: &str) -> Result<String, Box<dyn Error>> {
    let sizes = || sizes.iter().filter(|size| size.name.starts_with(family));
    let mut text = String::from(
        "/* Sizes the library was built for. They are part of the structs' layout, so no program can choose its \
         own. */\n",
    );
    for Size { name, value, .. } in sizes() {
        writeln!(text, "#if defined({name}) && ({name}) != {value}")?;
        writeln!(
            text,
            "#error \"libdeltarobot was built with {name}={value}: build it again with the size that this program \
             defines\"\n#endif"
        )?;
    }
    for Size { name, value, meaning } in sizes() {
        writeln!(text, "/** {meaning} */\n#ifndef {name}\n#define {name} {value}\n#endif")?;
    }
    text += "
/*
 * The sizes are part of the symbols' names too: a program compiled with this header does not link with a library
 * of other sizes. The plain names are there for programs compiled without it.
 */
#if defined(__GNUC__) || defined(__clang__) || defined(__TINYC__)
#define @FAMILY@_SIZED_STR_(text) #text
#define @FAMILY@_SIZED_STR(text) @FAMILY@_SIZED_STR_(text)
#ifdef __USER_LABEL_PREFIX__
#define @FAMILY@_SIZED(name) __asm__(@FAMILY@_SIZED_STR(__USER_LABEL_PREFIX__) name \"_@SUFFIX@\")
#else
#define @FAMILY@_SIZED(name) __asm__(name \"_@SUFFIX@\")
#endif
#else
#define @FAMILY@_SIZED(name)
#define @FAMILY@_SIZED_BY_MACRO
#endif";
    Ok(text)
}

/// A copy of a source file in which what `#[export(..)]` does to functions is written as cbindgen understands it.
fn exports_marked(source: &str) -> Result<String, Box<dyn Error>> {
    let text = fs::read_to_string(format!("{}/{source}", env::var("CARGO_MANIFEST_DIR")?))?;
    let mut pieces = text.split("#[export");
    let mut marked = String::from(pieces.next().unwrap_or_default());
    for piece in pieces {
        let (family, function) = piece.split_once(']').ok_or("#[export without an end")?;
        let name = function.split_once(" fn ").and_then(|(_, rest)| rest.split('(').next()).unwrap_or_default();
        let family = family.trim_matches(['(', ')']).to_uppercase();
        if !family.is_empty() {
            write!(marked, "///\n/// cbindgen:postfix={family}_SIZED(\"{name}\")\n")?;
        }
        write!(marked, "#[unsafe(no_mangle)]{function}")?;
    }
    let copy = format!("{}/{}", env::var("OUT_DIR")?, source.replace('/', "-"));
    fs::write(&copy, marked)?;
    Ok(copy)
}

/// Leaves a header that is as it should be alone, for the sake of those who make things depend on it.
fn write_if_new(path: &Path, text: &str) -> std::io::Result<()> {
    if fs::read(path).is_ok_and(|old| old == text.as_bytes()) { Ok(()) } else { fs::write(path, text) }
}

/// The text of a header: what its `.toml` says, and what all of them have in common.
fn header(path: &str, module: &str, types: &[&str], sizes: &[Size]) -> Result<String, Box<dyn Error>> {
    let manifest = env::var("CARGO_MANIFEST_DIR")?;
    let mut config = cbindgen::Config::from_file(format!("{manifest}/src/{module}.toml"))?;
    config.language = cbindgen::Language::C;
    // The posted header names no struct.
    config.style = if path.contains('/') { cbindgen::Style::Tag } else { cbindgen::Style::Type };
    config.documentation_style = cbindgen::DocumentationStyle::Doxy;
    config.no_includes = true;
    config.line_length = 110;
    // cbindgen's own guard and its extern "C" are no C89.
    let guard = path.to_uppercase().replace(['/', '.'], "_");
    config.header = config.header.map(|text| format!("{text}\n#ifndef {guard}\n#define {guard}"));
    config.after_includes =
        config.after_includes.map(|text| format!("{text}\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n"));
    config.trailer = Some("\n#ifdef __cplusplus\n}\n#endif\n\n#endif".into());

    let mut builder =
        cbindgen::Builder::new().with_config(config).with_src(exports_marked(&format!("src/{module}.rs"))?);
    for source in types {
        builder = builder.with_src(exports_marked(source)?);
    }
    let mut text = Vec::new();
    builder.generate()?.write(&mut text);
    // Comments shall not end with the empty line in front of what was for cbindgen.
    let mut text = String::from_utf8(text)?.replace("\n *\n */", "\n */");

    for family in FAMILIES {
        text = text.replace(&format!("@{family}_SIZES@"), &sizes_block(sizes, family)?);
        text = text.replace("@FAMILY@", family).replace("@SUFFIX@", &suffix(sizes, family));

        // For compilers that can't give a function another symbol, a macro does.
        let mut renames = String::new();
        for declaration in text.split(&format!("{family}_SIZED(\"")).skip(1) {
            let function = declaration.split('"').next().unwrap_or_default();
            writeln!(renames, "#define {function} {function}_{}", suffix(sizes, family))?;
        }
        let renames = format!("#ifdef {family}_SIZED_BY_MACRO\n{renames}#endif");
        text = text.replace(&format!("@{family}_SIZED_NAMES@"), &renames);
    }

    let version = |part: &str| env::var(format!("CARGO_PKG_VERSION{part}"));
    for (placeholder, value) in [
        ("@RULES@", RULES.into()),
        ("@TIMES@", TIMES.into()),
        ("@VERSION@", version("")?),
        ("@VERSION_MAJOR@", version("_MAJOR")?),
        ("@VERSION_MINOR@", version("_MINOR")?),
        ("@VERSION_PATCH@", version("_PATCH")?),
    ] {
        text = text.replace(placeholder, &value);
    }
    Ok(text)
}
