//! What cbindgen writes, as a person would write it.

/// Makes comments of one line of those that take three, and declarations of several lines of those that are too long.
pub(crate) fn tidy(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    let mut rest = text.trim().lines().peekable();
    while let Some(line) = rest.next() {
        let mut line = line.to_owned();
        if line.trim() == "/**" {
            line = comment(&line, &mut rest);
        } else if line.len() > 120 && line.ends_with(';') {
            line = declaration(&line);
        }
        // One blank line at most, and none between macros or fields that have a line each.
        let is_blank = line.trim().is_empty();
        if is_blank && lines.last().is_some_and(String::is_empty) {
            continue;
        }
        if line.starts_with("/** ") && rest.peek().is_some_and(|next| next.starts_with("#define")) && lines.len() >= 3 {
            let group = &lines[lines.len() - 3..];
            if group[2].is_empty() && group[1].starts_with("#define") && group[0].starts_with("/** ") {
                lines.pop();
            }
        }
        lines.push(if is_blank { String::new() } else { line });
    }
    lines.join("\n") + "\n"
}

/// Makes indented code, as C's comments have it, of the fenced code of Rust's.
pub(crate) fn indent_code(text: &str) -> String {
    let (mut indented, mut is_code) = (String::new(), false);
    for line in text.split_inclusive('\n') {
        if line.starts_with(" * ```") {
            is_code = !is_code;
        } else {
            indented += &if is_code { line.replacen("* ", "*     ", 1) } else { line.into() };
        }
    }
    indented
}

/// A comment that begins with this line, with its end.
fn comment<'a>(first: &str, rest: &mut impl Iterator<Item = &'a str>) -> String {
    let indent = first.len() - first.trim_start().len();
    let mut body: Vec<&str> = rest.by_ref().take_while(|line| line.trim() != "*/").collect();
    // The annotation of cbindgen leaves an empty line.
    while body.last().is_some_and(|line| line.trim() == "*") {
        body.pop();
    }
    let indent = " ".repeat(indent);
    match body[..] {
        [line] if line.len() + 6 <= 120 => format!("{indent}/** {} */", line.trim().trim_start_matches("* ")),
        _ => format!("{first}\n{}\n{indent} */", body.join("\n")),
    }
}

/// A declaration of a function that is too long for one line.
fn declaration(line: &str) -> String {
    let (mut text, mut width) = (String::new(), 0);
    for word in line.split_inclusive(", ").flat_map(|part| part.split_inclusive(") ")) {
        if width + word.trim_end().len() > 120 {
            text.truncate(text.trim_end().len());
            text += "\n    ";
            width = 4;
        }
        text += word;
        width += word.len();
    }
    text
}
