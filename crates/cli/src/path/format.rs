//! Kinds of files that paths are read from.

use std::path::Path;

use super::{Error, FILE_MAX, Placement, Waypoint, csv, gcode, svg};

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
#[value(rename_all = "lower")]
pub enum Format {
    /// A point a line: x, y and z.
    Csv,
    /// The outlines in a drawing.
    Svg,
    /// Lines and arcs of a program for machine tools.
    Gcode,
}

impl Format {
    /// What a file of this name is, if that says it.
    #[must_use]
    pub fn of_name(name: &Path) -> Option<Self> {
        match name.extension()?.to_ascii_lowercase().to_str()? {
            "csv" | "tsv" | "txt" => Some(Self::Csv),
            "svg" => Some(Self::Svg),
            "gcode" | "gc" | "nc" | "ngc" | "tap" | "cnc" => Some(Self::Gcode),
            _ => None,
        }
    }

    /// What a unit of the file's is in metres: that of a drawing, and of a program for machine tools, is a millimetre.
    #[must_use]
    pub const fn default_scale(self) -> f64 {
        match self {
            Self::Csv => 1.0,
            Self::Svg | Self::Gcode => 0.001,
        }
    }

    /// How far above the plane is travelled between strokes, in metres: only a drawing does not say that itself.
    #[must_use]
    pub const fn default_lift(self) -> f64 {
        match self {
            Self::Svg => 0.01,
            Self::Csv | Self::Gcode => 0.0,
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    ///
    /// It is too long, no text, or has something in it that this format does not have, or that can't be traced.
    pub fn read(self, file: &[u8], placement: &Placement) -> Result<Vec<Waypoint>, Error> {
        if file.len() > FILE_MAX {
            return Err(Error::new(format!("more than {} MB", FILE_MAX >> 20)));
        }
        let text = str::from_utf8(file).map_err(|error| {
            let before = file.get(..error.valid_up_to()).unwrap_or_default();
            Error::at(before.split(|byte| *byte == b'\n').count(), "not UTF-8 text")
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        match self {
            Self::Csv => csv::read(text, placement),
            Self::Svg => svg::read(text, placement),
            Self::Gcode => gcode::read(text, placement),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;

    use super::super::machine::tests::example;
    use super::super::{Placement, Plane, Waypoint, prepare_points};
    use super::{FILE_MAX, Format};

    /// The plane of x and y, without a lift.
    pub(in super::super) fn flat(tolerance: f64) -> Placement {
        let plane = Plane::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.0).unwrap();
        Placement::new(plane, tolerance, 0.0).unwrap()
    }

    pub(in super::super) fn read(format: Format, text: &str) -> Vec<Waypoint> {
        format.read(text.as_bytes(), &flat(0.01)).unwrap_or_else(|error| panic!("{error}: {text}"))
    }

    pub(in super::super) fn error(format: Format, text: &str) -> String {
        format.read(text.as_bytes(), &flat(0.01)).unwrap_err().to_string()
    }

    #[test]
    fn files_that_are_no_text_or_too_long() {
        let error = Format::Csv.read(b"1,2,3\n\xFF", &flat(0.1)).unwrap_err();
        assert_eq!(error.to_string(), "line 2: not UTF-8 text");
        assert_eq!(read(Format::Csv, "\u{feff}1,2,3").len(), 1);
        let error = Format::Csv.read(&vec![b'\n'; FILE_MAX + 1], &flat(0.1)).unwrap_err();
        assert_eq!(error.to_string(), "more than 32 MB");
    }

    /// Pieces of which hostile files are made: what the formats are made of, and numbers at their ends.
    fn pieces() -> impl Strategy<Value = String> {
        let piece = prop_oneof![
            prop::sample::select(vec![
                "G0",
                "G1",
                "G2",
                "G3",
                "G20",
                "G91",
                "X",
                "Y",
                "Z",
                "I",
                "J",
                "R",
                "(",
                ")",
                ";",
                "\n",
                "%",
                "N1",
                " ",
                ",",
                "\"",
                "#",
                "x,y,z\n",
                "1e308",
                "-1e308",
                "1e-320",
                "0",
                "-0",
                ".",
                "inf",
                "nan",
                "1",
                "2.5",
                "-3",
                "999999999999999999999",
                "</g>",
                "</svg>",
                "<svg>",
                "<svg viewBox='0 0 1 1'>",
                "<g transform='",
                "scale(",
                "rotate(",
                "matrix(",
                "'>",
                "<path d='",
                "M",
                "a",
                "A",
                "c",
                "C",
                "s",
                "q",
                "t",
                "z",
                "h",
                "v",
                "'/>",
                "<rect width='1' height='2' rx='",
                "<circle r='",
                "<polyline points='",
                "<!ENTITY",
                "&lt;",
                "<!--",
                "-->",
                "\u{202e}",
                "é",
            ])
            .prop_map(str::to_owned),
            any::<f64>().prop_map(|number| number.to_string()),
            any::<char>().prop_map(String::from),
        ];
        prop::collection::vec(piece, 0..60).prop_map(|pieces| pieces.concat())
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn hostile_files_end_in_points_or_an_error(text in pieces(), tolerance in 1e-5..10.0_f64) {
            for format in [Format::Csv, Format::Svg, Format::Gcode] {
                if let Ok(points) = format.read(text.as_bytes(), &flat(tolerance)) {
                    prop_assert!(points.iter().flat_map(|it| it.at).all(f64::is_finite));
                    let _ = prepare_points(points, tolerance, &example());
                }
            }
        }

        #[test]
        fn hostile_path_data_and_programs(data in "[MmLlHhVvCcSsQqTtAaZz0-9 ,.e-]{0,80}", code in "([GXYZIJR][0-9.-]{1,6} ?){1,20}") {
            let svg = format!("<svg><path d='M0 0{data}'/></svg>");
            for (format, text) in [(Format::Svg, svg), (Format::Gcode, code)] {
                if let Ok(points) = format.read(text.as_bytes(), &flat(0.001)) {
                    prop_assert!(points.iter().flat_map(|it| it.at).all(f64::is_finite));
                }
            }
        }
    }
}
