//! Sizes of the parts that are not generic over them yet.
use std::{env, fmt::Write, fs};

fn main() {
    let text = fs::read_to_string("../../src/sizes.mk").unwrap();
    let mut constants = String::new();
    for line in text.lines() {
        if let Some((name, default)) = line.split_once(" ?= ") {
            println!("cargo::rerun-if-env-changed={name}");
            let value = env::var(name).unwrap_or_else(|_| default.into());
            writeln!(constants, "pub const {name}: usize = {value};").unwrap();
        }
    }
    fs::write(format!("{}/sizes.rs", env::var("OUT_DIR").unwrap()), constants).unwrap();
}
