//! The words of a line of G-code: letters with numbers.

/// What a line has, without its comments.
#[derive(Debug, Default)]
pub(super) struct Words {
    /// Codes, without zeros that don't count.
    pub(super) g: Vec<String>,
    pub(super) x: Option<f64>,
    pub(super) y: Option<f64>,
    pub(super) z: Option<f64>,
    pub(super) i: Option<f64>,
    pub(super) j: Option<f64>,
    pub(super) r: Option<f64>,
    /// The line's number and the speed, which mean nothing here.
    n: Option<f64>,
    f: Option<f64>,
}

pub(super) fn words(line: &str) -> Result<Words, String> {
    let mut words = Words::default();
    let mut rest = line.trim();
    // Begins and ends a program on a tape.
    if rest == "%" {
        return Ok(words);
    }
    while let Some(letter) = rest.chars().next() {
        let behind = rest.get(letter.len_utf8()..).unwrap_or_default();
        rest = match letter {
            ';' => break,
            '(' => behind.split_once(')').ok_or("the comment does not end")?.1,
            'A'..='Z' | 'a'..='z' => {
                let (number, behind) = number(behind);
                words.add(letter.to_ascii_uppercase(), number)?;
                behind
            }
            _ => return Err(format!("`{letter}` is not expected here")),
        }
        .trim_start();
    }
    Ok(words)
}

/// The letters of a number at the beginning, and what is behind them.
fn number(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    let end = text.find(|letter: char| !matches!(letter, '0'..='9' | '.' | '+' | '-')).unwrap_or(text.len());
    text.split_at_checked(end).unwrap_or((text, ""))
}

impl Words {
    fn add(&mut self, letter: char, number: &str) -> Result<(), String> {
        let value = match number.parse::<f64>() {
            Ok(value) => value,
            Err(_) if number.is_empty() => return Err(format!("a number is missing behind {letter}")),
            Err(_) => return Err(format!("`{number}` is not a number")),
        };
        let slot = match letter {
            'G' => {
                self.g.push(value.to_string());
                return Ok(());
            }
            'X' => &mut self.x,
            'Y' => &mut self.y,
            'Z' => &mut self.z,
            'I' => &mut self.i,
            'J' => &mut self.j,
            'R' => &mut self.r,
            'N' => &mut self.n,
            'F' => &mut self.f,
            _ => {
                let supported = "only G0 to G3, G20, G21, G90 and G91 are";
                return Err(format!("{letter}{number} is not supported: {supported}"));
            }
        };
        if slot.replace(value).is_some() { Err(format!("{letter} occurs twice")) } else { Ok(()) }
    }
}
