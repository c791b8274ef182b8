//! Fixes the sizes and generates the C headers for them.
//!
//! Reads from the environment: `DP_BUFSIZE` and `DP_DATA_MAX_SIZE` (see `src/config.rs`), and `DP_HEADER_DIR`,
//! the directory that shall receive the headers (`make` sets it; without it they stay in cargo's `OUT_DIR`).

use std::{env, error::Error, fs, path::Path};

/// The headers: `NAME.h` is generated from `src/ffi/NAME.rs` (and the further files named here, for types whose
/// layout it shows) with the settings in `src/ffi/NAME.toml`.
const HEADERS: [(&str, &[&str]); 2] = [("protocol", &["src/deltarobot/ring.rs"]), ("protocol_ext", &[])];

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
    for (name, types) in HEADERS {
        header(name, types, &bufsize, &data_max)?.write_to_file(Path::new(&dir).join(format!("{name}.h")));
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

fn header(name: &str, types: &[&str], bufsize: &str, data_max: &str) -> Result<cbindgen::Bindings, Box<dyn Error>> {
    let manifest = env::var("CARGO_MANIFEST_DIR")?;
    let mut config = cbindgen::Config::from_file(format!("{manifest}/src/ffi/{name}.toml"))?;
    let version = |part: &str| env::var(format!("CARGO_PKG_VERSION{part}"));
    for (placeholder, value) in [
        ("@DP_BUFSIZE@", bufsize),
        ("@DP_DATA_MAX_SIZE@", data_max),
        ("@VERSION@", &version("")?),
        ("@VERSION_MAJOR@", &version("_MAJOR")?),
        ("@VERSION_MINOR@", &version("_MINOR")?),
        ("@VERSION_PATCH@", &version("_PATCH")?),
    ] {
        config.after_includes = config.after_includes.map(|text| text.replace(placeholder, value));
    }
    let mut builder = cbindgen::Builder::new().with_config(config).with_src(format!("{manifest}/src/ffi/{name}.rs"));
    for source in types {
        builder = builder.with_src(format!("{manifest}/{source}"));
    }
    Ok(builder.generate()?)
}
