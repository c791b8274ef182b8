//! Fixes the sizes and generates the C headers for them.
//!
//! Reads from the environment: `DP_BUFSIZE` and `DP_DATA_MAX_SIZE` (see `src/config.rs`), and `DP_HEADER_DIR`,
//! the directory that shall receive the headers (`make` sets it; without it they stay in cargo's `OUT_DIR`).

use std::{env, error::Error, fmt::Write, fs, path::Path};

/// The headers: `NAME.h` is generated from `src/ffi/NAME.rs` (and the further files named here, for types whose
/// layout it shows) with the settings in `src/ffi/NAME.toml`.
const HEADERS: [(&str, &[&str]); 6] = [
    ("protocol", &["src/deltarobot/ring.rs"]),
    ("protocol_ext", &[]),
    ("payload", &[]),
    (
        "host",
        &[
            "src/deltarobot/host.rs",
            "src/deltarobot/host/health.rs",
            "src/deltarobot/host/link.rs",
            "src/deltarobot/host/request.rs",
            "src/deltarobot/host/settings.rs",
        ],
    ),
    ("controller", &["src/deltarobot/controller.rs"]),
    ("serial", &["src/serial.rs"]),
];

fn main() -> Result<(), Box<dyn Error>> {
    let bufsize = size("DP_BUFSIZE", 128)?;
    let data_max = size("DP_DATA_MAX_SIZE", 32)?;
    let out = env::var("OUT_DIR")?;

    fs::write(
        Path::new(&out).join("sizes.rs"),
        format!(
            "/// Bytes that a ring holds, by default 128.\npub const DP_BUFSIZE: usize = {bufsize};\n\
             /// Longest payload of a frame in bytes, 1 to 255, by default 32.\npub const DP_DATA_MAX_SIZE: usize = {data_max};\n"
        ),
    )?;
    println!("cargo::rustc-env=DP_SIZES={bufsize}_{data_max}");

    println!("cargo::rerun-if-env-changed=DP_HEADER_DIR");
    println!("cargo::rerun-if-changed=src");
    let dir = env::var("DP_HEADER_DIR").unwrap_or_else(|_| format!("{out}/include/libdeltarobot"));
    fs::create_dir_all(&dir)?;
    for (name, types) in HEADERS {
        write_if_new(&Path::new(&dir).join(format!("{name}.h")), &header(name, types, &bufsize, &data_max)?)?;
    }
    Ok(())
}

/// The size that the environment asks for, as a decimal number. Its range is `src/config.rs`'s business.
fn size(name: &str, default: u32) -> Result<String, String> {
    println!("cargo::rerun-if-env-changed={name}");
    let Ok(text) = env::var(name) else {
        return Ok(default.to_string());
    };
    match text.trim().parse::<u32>() {
        Ok(value) => Ok(value.to_string()),
        Err(_) => Err(format!("{name}={text}: not a whole number of bytes")),
    }
}

/// Leaves a header that is as it should be alone, for the sake of those who make things depend on it.
fn write_if_new(path: &Path, text: &str) -> std::io::Result<()> {
    if fs::read(path).is_ok_and(|old| old == text.as_bytes()) { Ok(()) } else { fs::write(path, text) }
}

/// The text of a header: what its `.toml` says, and what all of them have in common.
fn header(name: &str, types: &[&str], bufsize: &str, data_max: &str) -> Result<String, Box<dyn Error>> {
    let manifest = env::var("CARGO_MANIFEST_DIR")?;
    let mut config = cbindgen::Config::from_file(format!("{manifest}/src/ffi/{name}.toml"))?;
    config.language = cbindgen::Language::C;
    config.style = cbindgen::Style::Tag;
    config.documentation_style = cbindgen::DocumentationStyle::C;
    config.no_includes = true;
    config.line_length = 110;
    // cbindgen's own guard and its extern "C" are no C89.
    let guard = format!("LIBDELTAROBOT_{}_H", name.to_uppercase());
    config.header = config.header.map(|text| format!("{text}\n#ifndef {guard}\n#define {guard}"));
    config.after_includes =
        config.after_includes.map(|text| format!("{text}\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n"));
    config.trailer = Some("\n#ifdef __cplusplus\n}\n#endif\n\n#endif".into());

    let mut builder = cbindgen::Builder::new().with_config(config).with_src(format!("{manifest}/src/ffi/{name}.rs"));
    for source in types {
        builder = builder.with_src(format!("{manifest}/{source}"));
    }
    let mut text = Vec::new();
    builder.generate()?.write(&mut text);
    let mut text = String::from_utf8(text)?;

    // For compilers that can't give a function another symbol, a macro does.
    let mut renames = String::from("#ifdef DP_SIZED_BY_MACRO\n");
    for declaration in text.split("DP_SIZED(\"").skip(1) {
        let function = declaration.split('"').next().unwrap_or_default();
        writeln!(renames, "#define {function} {function}_{bufsize}_{data_max}")?;
    }
    renames += "#endif";

    let version = |part: &str| env::var(format!("CARGO_PKG_VERSION{part}"));
    for (placeholder, value) in [
        ("@SIZED_NAMES@", renames.as_str()),
        ("@DP_BUFSIZE@", bufsize),
        ("@DP_DATA_MAX_SIZE@", data_max),
        ("@VERSION@", &version("")?),
        ("@VERSION_MAJOR@", &version("_MAJOR")?),
        ("@VERSION_MINOR@", &version("_MINOR")?),
        ("@VERSION_PATCH@", &version("_PATCH")?),
    ] {
        text = text.replace(placeholder, value);
    }
    Ok(text)
}
