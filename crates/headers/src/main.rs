//! `deltarobot-headers DIRECTORY` makes the C headers of `src/*.rs`, with cbindgen and `src/headers.toml`, in a directory
//! like `include/`; those that are as they should be are left alone. Run at the root of the source tree, by `make
//! header`. Of the sizes they depend on `sizes.h` alone, which the library's build script writes.
#![allow(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    reason = "a tool for developers, which may stop at what it does not expect"
)]

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

mod tidy;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A header, as `src/headers.toml` describes it.
struct Header {
    /// `host`, of `src/host.rs`.
    module: String,
    settings: Table,
    sources: Vec<PathBuf>,
    /// In the order of their declarations, which the header keeps.
    types: Vec<Type>,
}

/// A type that is declared in a header.
struct Type {
    name: String,
    in_c: String,
    is_struct: bool,
}

fn main() -> Result<()> {
    let directory = std::env::args().nth(1).ok_or("usage: deltarobot-headers DIRECTORY")?;
    let work = Path::new("target/headers");
    for (path, text) in headers(Path::new("."), work)? {
        let path = Path::new(&directory).join(path);
        if !fs::read(&path).is_ok_and(|old| old == text.as_bytes()) {
            fs::write(path, text)?;
        }
    }
    Ok(())
}

/// All headers: their paths below `include/`, and their texts. `work` is a directory for copies of the sources.
fn headers(root: &Path, work: &Path) -> Result<Vec<(String, String)>> {
    fs::create_dir_all(work)?;
    let list: Table = fs::read_to_string(root.join("src/headers.toml"))?.parse()?;
    let headers =
        list.into_iter().map(|(module, settings)| Header::new(root, module, settings)).collect::<Result<Vec<_>>>()?;
    headers.iter().map(|header| Ok((header.path(), header.text(root, work, &headers)?))).collect()
}

impl Header {
    fn new(root: &Path, module: String, settings: Value) -> Result<Self> {
        let Value::Table(settings) = settings else { return Err(format!("{module} is no table").into()) };
        let mut sources = vec![root.join(format!("src/{module}.rs"))];
        if let Ok(parts) = fs::read_dir(root.join(format!("src/{module}"))) {
            let mut parts: Vec<_> = parts.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
            parts.retain(|path| path.extension().is_some_and(|extension| extension == "rs"));
            parts.sort();
            sources.append(&mut parts);
        }
        let mut header = Self { module, settings, sources, types: Vec::new() };
        for source in header.sources.clone() {
            for line in fs::read_to_string(&source)?.lines() {
                let Some((kind, rest)) = line.strip_prefix("pub ").and_then(|rest| rest.split_once(' ')) else {
                    continue;
                };
                let name = rest.split(|letter: char| !letter.is_alphanumeric()).next().unwrap_or_default();
                if matches!(kind, "struct" | "union" | "type") && !name.is_empty() {
                    let in_c = header.name_of(name, rest.contains("= Option<unsafe extern"));
                    header.types.push(Type { name: name.into(), in_c, is_struct: kind != "type" });
                }
            }
        }
        Ok(header)
    }

    /// A list of its settings.
    fn list(&self, key: &str) -> Vec<String> {
        let values = self.settings.get(key).and_then(Value::as_array);
        values.into_iter().flatten().filter_map(|value| value.as_str().map(String::from)).collect()
    }

    /// What a type of its own is called in C.
    fn name_of(&self, name: &str, is_function: bool) -> String {
        let renamed = self.settings.get("rename").and_then(|names| names.get(name)).and_then(Value::as_str);
        if renamed.is_some() || self.is_posted() {
            return renamed.unwrap_or(name).into();
        }
        let mut snake = String::from(self.settings.get("prefix").and_then(Value::as_str).unwrap_or("dp_"));
        for letter in name.chars() {
            if letter.is_ascii_uppercase() && !snake.ends_with('_') {
                snake.push('_');
            }
            snake.push(letter.to_ascii_lowercase());
        }
        if is_function { snake + "_t" } else { snake }
    }

    fn is_posted(&self) -> bool {
        self.module == "contouring_protocol"
    }

    fn path(&self) -> String {
        if self.is_posted() { "ContouringProtocol.h".into() } else { format!("libdeltarobot/{}.h", self.module) }
    }

    fn text(&self, root: &Path, work: &Path, all: &[Self]) -> Result<String> {
        let mut config = cbindgen::Config {
            language: cbindgen::Language::C,
            // The posted header names no struct.
            style: if self.is_posted() { cbindgen::Style::Type } else { cbindgen::Style::Tag },
            documentation_style: cbindgen::DocumentationStyle::Doxy,
            no_includes: true,
            line_length: usize::MAX,
            ..cbindgen::Config::default()
        };
        for header in all {
            let is_own = header.module == self.module;
            for Type { name, in_c, is_struct } in &header.types {
                // Types of other headers need their struct in front: cbindgen does not see their declarations.
                let in_c = if *is_struct && !is_own { format!("struct {in_c}") } else { in_c.clone() };
                if is_own || self.types.iter().all(|own| own.name != *name) {
                    config.export.rename.insert(name.clone(), in_c);
                }
            }
        }
        if let Some(Value::Table(names)) = self.settings.get("rename") {
            let names = names.iter().filter_map(|(name, in_c)| Some((name.clone(), in_c.as_str()?.to_owned())));
            config.export.rename.extend(names);
        }
        config.export.exclude = self.list("exclude");
        // Declared even if no function mentions them.
        let names = self.types.iter().map(|own| &own.name);
        config.export.include = names.filter(|name| !config.export.exclude.contains(name)).cloned().collect();

        let mut builder = cbindgen::Builder::new().with_config(config);
        let mut sized = String::new();
        for source in &self.sources {
            let text = fs::read_to_string(source)?;
            let copy = work.join(source.strip_prefix(root)?.to_string_lossy().replace('/', "-"));
            fs::write(&copy, mark_exports(&text, &mut sized)?)?;
            builder = builder.with_src(copy);
        }
        let mut declarations = Vec::new();
        builder.generate()?.write(&mut declarations);
        let declarations = tidy::tidy(&String::from_utf8(declarations)?);

        let module = fs::read_to_string(root.join(format!("src/{}.rs", self.module)))?;
        let macros = fs::read_to_string(root.join(format!("src/{}/macros.h", self.module))).unwrap_or_default();
        self.wrapped(&head(&module), &sized, &macros, &declarations)
    }

    /// Puts a header together.
    fn wrapped(&self, head: &str, sized: &str, macros: &str, declarations: &str) -> Result<String> {
        let path = self.path();
        let guard = path.to_uppercase().replace(['/', '.'], "_");
        let own = if self.is_posted() { "libdeltarobot/" } else { "" };
        let mut text = format!("/**\n * @file\n{head} *\n * Rules for pointers, threads, callbacks and times: ");
        write!(text, "libdeltarobot/abi.h.\n * Generated from src/{}.rs by `make header`.\n */\n", self.module)?;
        write!(text, "#ifndef {guard}\n#define {guard}\n\n#include \"{own}abi.h\"\n")?;
        for include in self.list("includes") {
            writeln!(text, "#include \"{include}\"")?;
        }
        writeln!(text, "\nLIBDELTAROBOT_NOT_PACKED({});\n", self.module)?;
        if !sized.is_empty() {
            write!(text, "#ifdef LIBDELTAROBOT_SIZED_BY_MACRO\n{sized}#endif\n\n")?;
        }
        if !macros.is_empty() {
            writeln!(text, "{}\n", with_version(macros.trim_end()))?;
        }
        // cbindgen's own guard and its extern "C" are no C89.
        write!(text, "#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n{declarations}\n")?;
        text += "#ifdef __cplusplus\n}\n#endif\n\n#endif\n";
        Ok(tidy::indent_code(&text))
    }
}

/// The head of a header: what is said of the module, of which the first word is the header's path.
fn head(module: &str) -> String {
    let lines = module.lines().map_while(|line| line.strip_prefix("//!"));
    let head = lines.fold(String::new(), |head, line| head + " *" + line + "\n");
    head.replacen('`', "", 2)
}

/// The text with the version that all of the workspace has.
fn with_version(text: &str) -> String {
    let mut text = text.replace("@VERSION@", env!("CARGO_PKG_VERSION"));
    for (part, number) in ["MAJOR", "MINOR", "PATCH"].into_iter().zip(env!("CARGO_PKG_VERSION").split('.')) {
        text = text.replace(&format!("@VERSION_{part}@"), number);
    }
    text
}

/// A source in which what `#[export(..)]` does to functions is written as cbindgen understands it. Collects the macros
/// that rename those with sizes for compilers that can't give a function another symbol.
fn mark_exports(text: &str, sized: &mut String) -> Result<String> {
    let mut pieces = text.split("\n#[export");
    let mut marked = String::from(pieces.next().unwrap_or_default());
    for piece in pieces {
        let (family, function) = piece.split_once(']').ok_or("#[export without an end")?;
        let name = function.split_once(" fn ").and_then(|(_, rest)| rest.split('(').next()).unwrap_or_default();
        let family = family.trim_matches(['(', ')']).to_uppercase();
        if !family.is_empty() {
            writeln!(sized, "#define {name} {family}_SIZED_NAME({name})")?;
            write!(marked, "\n///\n/// cbindgen:postfix={family}_SIZED({name})")?;
        }
        write!(marked, "\n#[unsafe(no_mangle)]{function}")?;
    }
    Ok(marked)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test that can't go on fails")]
mod tests {
    use std::{fs, path::Path};

    #[test]
    fn the_checked_in_headers_are_fresh() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let work = root.join("target/headers-test");
        for (path, text) in super::headers(&root, &work).unwrap() {
            let checked_in = fs::read_to_string(root.join("include").join(&path)).unwrap_or_default();
            assert!(text == checked_in, "include/{path} is stale: run `make header`");
        }
    }
}
