//! G-code: G0 travels, G1, G2 and G3 draw, the arcs in the plane of x and y, with Z going along evenly. G90 and G91, G20
//! and G21 are what they are elsewhere; millimetres and absolute coordinates at first. Speeds are not used. All else is
//! refused, since what it would do to the path is not known.

mod arc;
mod words;

use super::{Error, Pen, Placement, Waypoint};
use arc::{Arc, centre_of};
use words::{Words, words};

const MM_PER_INCH: f64 = 25.4;

/// What a line's coordinates are the end of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Travel,
    Line,
    Arc { clockwise: bool },
}

/// What earlier lines have set.
struct Machine {
    motion: Option<Motion>,
    is_relative: bool,
    mm: f64,
    /// In millimetres.
    at: [f64; 3],
    pen: Pen,
    tolerance: f64,
    has_begun: bool,
}

pub(super) fn read(text: &str, placement: &Placement) -> Result<Vec<Waypoint>, Error> {
    let mut machine = Machine {
        motion: None,
        is_relative: false,
        mm: 1.0,
        at: [0.0; 3],
        pen: Pen::new(*placement),
        tolerance: placement.file_tolerance(),
        has_begun: false,
    };
    for (number, line) in (1..).zip(text.lines()) {
        let words = words(line).map_err(|message| Error::at(number, message))?;
        machine.obey(&words, number)?;
    }
    machine.pen.finish()
}

impl Machine {
    fn obey(&mut self, words: &Words, number: usize) -> Result<(), Error> {
        let refused = |message: &str| Error::at(number, message);
        self.set(words).map_err(|message| Error::at(number, message))?;
        let to = self.target(words);
        let offset = [words.i, words.j];
        let is_arc = matches!(self.motion, Some(Motion::Arc { .. }));
        let has_centre = words.r.is_some() || offset.iter().any(Option::is_some);
        if has_centre && !is_arc {
            return Err(refused("I, J and R belong to G2 and G3"));
        }
        if !has_centre && [words.x, words.y, words.z].iter().all(Option::is_none) {
            return Ok(());
        }
        match self.motion.ok_or_else(|| refused("coordinates before any of G0 to G3"))? {
            Motion::Travel => self.pen.travel(to, number)?,
            Motion::Line => {
                self.begin(number)?;
                self.pen.draw(to, number)?;
            }
            Motion::Arc { clockwise } => {
                self.begin(number)?;
                let centre = match (words.r, offset) {
                    (Some(_), [Some(_), _] | [_, Some(_)]) => return Err(refused("R and I or J in the same line")),
                    (Some(r), _) => centre_of(self.at, to, r * self.mm, clockwise).map_err(refused)?,
                    (None, [None, None]) => return Err(refused("an arc needs I and J, or R")),
                    (None, [i, j]) => {
                        let [x, y, _] = self.at;
                        [x + i.unwrap_or(0.0) * self.mm, y + j.unwrap_or(0.0) * self.mm]
                    }
                };
                let arc = Arc::new(self.at, to, centre, clockwise).map_err(refused)?;
                for point in arc.flattened(self.tolerance).map_err(refused)? {
                    self.pen.draw(point, number)?;
                }
            }
        }
        self.has_begun = true;
        self.at = to;
        Ok(())
    }

    /// A program that begins with drawing begins at zero.
    fn begin(&mut self, number: usize) -> Result<(), Error> {
        if self.has_begun { Ok(()) } else { self.pen.travel(self.at, number) }
    }

    fn set(&mut self, words: &Words) -> Result<(), String> {
        let [mut motions, mut distances, mut units] = [0; 3];
        for code in &words.g {
            match code.as_str() {
                "0" => self.motion = Some(Motion::Travel),
                "1" => self.motion = Some(Motion::Line),
                "2" => self.motion = Some(Motion::Arc { clockwise: true }),
                "3" => self.motion = Some(Motion::Arc { clockwise: false }),
                "20" => self.mm = MM_PER_INCH,
                "21" => self.mm = 1.0,
                "90" => self.is_relative = false,
                "91" => self.is_relative = true,
                other => return Err(format!("G{other} is none of G0 to G3, G20, G21, G90 and G91")),
            }
            let group = match code.as_str() {
                "20" | "21" => &mut units,
                "90" | "91" => &mut distances,
                _ => &mut motions,
            };
            *group += 1;
            if *group > 1 {
                return Err(format!("G{code} contradicts another G of the same line"));
            }
        }
        Ok(())
    }

    /// Where a line's coordinates lead to, in millimetres.
    fn target(&self, words: &Words) -> [f64; 3] {
        let [x, y, z] = self.at;
        let go = |at: f64, word: Option<f64>| match word {
            None => at,
            Some(word) if self.is_relative => at + word * self.mm,
            Some(word) => word * self.mm,
        };
        [go(x, words.x), go(y, words.y), go(z, words.z)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::Format::Gcode;
    use super::super::format::tests::{error, read};

    fn ends(text: &str) -> Vec<([f64; 3], bool, usize)> {
        read(Gcode, text).iter().map(|it| (it.at, it.is_drawing, it.line)).collect()
    }

    #[test]
    fn lines_in_both_units_and_ways() {
        let text = "%\n(made by hand) N10 g21 G90\nN20 G00 X1 Y2 ; above\nG1 Z-.5 F100\nG91 X+2 (on) Y 1.\ng20 x1\nG90 G0 Z0\n";
        assert_eq!(
            ends(text),
            [
                ([1.0, 2.0, 0.0], false, 3),
                ([1.0, 2.0, -0.5], true, 4),
                ([3.0, 3.0, -0.5], true, 5),
                ([28.4, 3.0, -0.5], true, 6),
                ([28.4, 3.0, 0.0], false, 7)
            ]
        );
        assert_eq!(ends("G1 X1"), [([0.0; 3], false, 1), ([1.0, 0.0, 0.0], true, 1)]);
    }

    #[test]
    fn arcs_keep_to_their_circle() {
        // A quarter, three quarters, a whole circle, and all of them again by R where that is possible.
        for (text, to, angle) in [
            ("G0 X10\nG3 X0 Y10 I-10 J0", [0.0, 10.0], 90.0),
            ("G0 X10\nG3 X0 Y10 R10", [0.0, 10.0], 90.0),
            ("G0 X10\nG2 X0 Y10 I-10", [0.0, 10.0], 270.0),
            ("G0 X10\nG2 X0 Y10 R-10", [0.0, 10.0], 270.0),
            ("G0 X10\nG2 I-10", [10.0, 0.0], 360.0),
            ("G0 X10\nG91 G3 X-20 R10", [-10.0, 0.0], 180.0),
        ] {
            let points = read(Gcode, &format!("{text} Z6\n"));
            let mut length = 0.0;
            for (number, pair) in points[..].windows(2).enumerate() {
                let [a, b] = [pair[0].at, pair[1].at];
                let middle = [f64::midpoint(a[0], b[0]), f64::midpoint(a[1], b[1])];
                for at in [[b[0], b[1]], middle] {
                    assert!((at[0].hypot(at[1]) - 10.0).abs() <= 0.0101, "{text}: {at:?}");
                }
                length += (b[0] - a[0]).hypot(b[1] - a[1]);
                let even = 6.0 * f64::from(u32::try_from(number + 1).unwrap())
                    / f64::from(u32::try_from(points.len() - 1).unwrap());
                assert!((b[2] - even).abs() < 1e-9 || text.contains("G91"), "{text}: {b:?}");
            }
            let last = points.last().unwrap().at;
            assert_eq!(last, [to[0], to[1], 6.0], "{text}");
            assert!((length - 10.0 * f64::to_radians(angle)).abs() < 0.1, "{text}: {length}");
        }
    }

    #[test]
    fn all_else_is_refused_by_line() {
        for (text, said) in [
            ("", "there are no points"),
            ("G21\nG90\n", "there are no points"),
            ("X1\n", "line 1: coordinates before any of G0 to G3"),
            ("G0 X1\nM3 S1000\n", "line 2: M3 is not supported: only G0 to G3, G20, G21, G90 and G91 are"),
            ("G0 X1\n\nG4 P1\n", "line 3: P1 is not supported: only G0 to G3, G20, G21, G90 and G91 are"),
            ("G28\n", "line 1: G28 is none of G0 to G3, G20, G21, G90 and G91"),
            ("G91.1\n", "line 1: G91.1 is none of G0 to G3, G20, G21, G90 and G91"),
            ("G0 G1 X1\n", "line 1: G1 contradicts another G of the same line"),
            ("G0 X1 X2\n", "line 1: X occurs twice"),
            ("G0 X\n", "line 1: a number is missing behind X"),
            ("G0 X1e5\n", "line 1: E5 is not supported: only G0 to G3, G20, G21, G90 and G91 are"),
            ("G0 X--1\n", "line 1: `--1` is not a number"),
            ("G0 X1 *71\n", "line 1: `*` is not expected here"),
            ("G0 X1 (never ends\n", "line 1: the comment does not end"),
            ("G0 X1 I2\n", "line 1: I, J and R belong to G2 and G3"),
            ("G2 X1\n", "line 1: an arc needs I and J, or R"),
            ("G2 X1 I1 R1\n", "line 1: R and I or J in the same line"),
            ("G2 X10 R4\n", "line 1: the ends of the arc are farther apart than R allows"),
            ("G2 X0 Y0 R4\n", "line 1: an arc by R needs two different ends"),
            ("G2 X10 I3\n", "line 1: the ends of the arc have different distances from its centre"),
            ("G2 X0 I0 J0\n", "line 1: the ends of the arc lie at its centre"),
        ] {
            assert_eq!(error(Gcode, text), said, "{text:?}");
        }
        let far = "9".repeat(60);
        assert!(error(Gcode, &format!("G3 X0 Y0 I{far}\n")).contains("too large for the tolerance"));
        assert!(error(Gcode, &format!("G0 X{}", "9".repeat(400))).contains("not finite"));
    }
}
