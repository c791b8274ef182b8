use std::fmt::Write as _;

use super::super::Format::Svg;
use super::super::format::tests::{error, flat, read};
use super::super::{Placement, Plane};

/// The places of the points of a drawing with 96 pixels an inch, whose y go up from 0, in pixels.
fn traced(content: &str) -> Vec<([f64; 2], bool)> {
    let svg = format!("<svg xmlns='http://www.w3.org/2000/svg'>{content}</svg>");
    let pixels = |number: f64| (number / 25.4 * 96.0 * 1e6).round() / 1e6 + 0.0;
    read(Svg, &svg).iter().map(|it| ([pixels(it.at[0]), pixels(it.at[1])], it.is_drawing)).collect()
}

fn drawn(content: &str, points: &[[f64; 2]]) {
    let traced = traced(content);
    let places: Vec<_> = traced.iter().map(|(at, _)| *at).collect();
    assert_eq!(places, points, "{content}");
    assert!(!traced[0].1 && traced[1..].iter().all(|(_, is_drawing)| *is_drawing), "{content}");
}

#[test]
fn lines_in_all_ways() {
    let square = [[1.0, -1.0], [3.0, -1.0], [3.0, -3.0], [1.0, -3.0], [1.0, -1.0]];
    for content in [
        "<path d='M1 1 L3 1 L3 3 L1 3 Z'/>",
        "<path d='m1,1h2v2h-2z'/>",
        "<path d='M1 1H3V3H1V1'/>",
        "<polygon points='1 1 3,1 3 3 1,3'/>",
        "<polyline points='1,1 3,1 3,3 1,3 1,1'/>",
        "<rect x='1' y='1' width='2' height='2'/>",
        "<g transform='translate(1 1)'><a><rect transform='scale(2)' width='1' height='1'/></a></g>",
        "<rect transform='rotate(90 3 3) translate(1,3)' width='1pc' height='2' style='stroke:none; text-transform: none'/>",
    ] {
        if content.contains("1pc") {
            assert_eq!(traced(content).len(), 5);
        } else {
            drawn(content, &square);
        }
    }
    drawn("<line x1='1in' y1='-1cm' x2='10mm' y2='3pt'/>", &[[96.0, 37.795_276], [37.795_276, -4.0]]);
    drawn("<path transform='matrix(0 1 -1 0 0 0)' d='M1 2L3 4'/>", &[[-2.0, -1.0], [-4.0, -3.0]]);
    drawn("<path transform='skewX(45)' d='M0 1L0 2'/>", &[[1.0, -1.0], [2.0, -2.0]]);
    drawn("<path transform='skewY(45)' d='M1 0L2 0'/>", &[[1.0, -1.0], [2.0, -2.0]]);
}

#[test]
fn after_closing_a_path_goes_on_where_it_began() {
    let traced = traced("<path d='M1 1h2v2zl-1 0m1 1h1'/>");
    let places: Vec<_> = traced.iter().map(|(at, is_drawing)| (at[0], -at[1], *is_drawing)).collect();
    let (up, down) = (false, true);
    assert_eq!(
        places,
        [
            (1.0, 1.0, up),
            (3.0, 1.0, down),
            (3.0, 3.0, down),
            (1.0, 1.0, down),
            (0.0, 1.0, down),
            (1.0, 2.0, up),
            (2.0, 2.0, down)
        ]
    );
}

/// The largest distance from a circle of radius 50 about 0, of points and of the middles between them; and the length.
fn off_circle(content: &str) -> (f64, f64) {
    let points: Vec<_> = traced(content).iter().map(|(at, _)| *at).collect();
    let mut worst: f64 = 0.0;
    let mut length = 0.0;
    for pair in points.windows(2) {
        let middle = [f64::midpoint(pair[0][0], pair[1][0]), f64::midpoint(pair[0][1], pair[1][1])];
        for at in [pair[0], middle, pair[1]] {
            worst = worst.max((at[0].hypot(at[1]) - 50.0).abs());
        }
        length += (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
    }
    (worst, length)
}

#[test]
fn round_shapes_keep_to_the_tolerance() {
    let (whole, tolerance) = (50.0 * std::f64::consts::TAU, 0.01 / 25.4 * 96.0);
    for (content, length) in [
        ("<circle r='50'/>", whole),
        ("<ellipse rx='50' ry='50'/>", whole),
        ("<circle cx='1' r='5' transform='scale(10) translate(-1)'/>", whole),
        ("<ellipse rx='5' ry='100' transform='scale(10 .5)'/>", whole),
        ("<rect x='-50' y='-50' width='100' height='100' rx='50'/>", whole),
        ("<rect x='-50' y='-50' width='100' height='100' ry='80'/>", whole),
        ("<path d='M50 0A50 50 0 0 1 0 50'/>", whole / 4.0),
        ("<path d='M50 0a50 50 0 0 1-50 50'/>", whole / 4.0),
        ("<path d='M50 0A50 50 30 1 0 0 50'/>", whole * 0.75),
        // Too small for its ends, so it grows.
        ("<path d='M50 0A1 1 0 0 0-50 0'/>", whole / 2.0),
        // Flags may stand without anything between them.
        ("<path d='M50 0a50 50 0 01-50 50'/>", whole / 4.0),
    ] {
        let (worst, traced) = off_circle(content);
        assert!(worst <= tolerance, "{content}: off by {worst}");
        assert!((traced - length).abs() < length * 1e-3, "{content}: {traced} instead of {length}");
    }
    // What has a side of no length is not drawn.
    for nothing in ["<circle r='0'/>", "<ellipse rx='1'/>", "<rect width='1'/>", "<path/>"] {
        assert_eq!(traced(&format!("{nothing}<path d='M1 1h1'/>")).len(), 2, "{nothing}");
    }
}

#[test]
fn curves_and_their_smooth_kin() {
    let all = |data: &str| traced(&format!("<path d='{data}'/>"));
    let arch = all("M0 0C0 10 10 10 10 0C10-10 20-10 20 0");
    assert!(arch.len() > 10);
    for same in ["M0 0c0 10 10 10 10 0s10-10 10 0", "M0 0C0 10 10 10 10 0S20-10 20 0"] {
        assert_eq!(all(same), arch, "{same}");
    }
    let wave = all("M0 0Q5 10 10 0Q15-10 20 0");
    assert!(wave.len() > 10 && wave != arch);
    for same in ["M0 0q5 10 10 0t10 0", "M0 0Q5 10 10 0T20 0"] {
        assert_eq!(all(same), wave, "{same}");
    }
    // Without a curve of its kind before it, there is nothing to mirror.
    assert_eq!(all("M0 0Q5 10 10 0S20-10 20 0"), all("M0 0Q5 10 10 0C10 0 20-10 20 0"));
    assert_eq!(all("M0 0L10 0T20 0"), [([0.0, 0.0], false), ([10.0, 0.0], true), ([20.0, 0.0], true)]);
    // The middle of a cubic is at (p0 + 3 p1 + 3 p2 + p3) / 8.
    let nearest =
        all("M0 0C0 10 10 10 10 0").iter().map(|(at, _)| (at[0] - 5.0).hypot(at[1] + 7.5)).fold(9.0, f64::min);
    assert!(nearest < 0.4, "{nearest}");
}

#[test]
fn the_page_is_in_millimetres_from_its_lower_left_corner() {
    for (head, wanted) in [
        ("", [2.0, -1.0].map(|pixels: f64| pixels * 25.4 / 96.0)),
        ("height='96'", [2.0, 95.0].map(|pixels: f64| pixels * 25.4 / 96.0)),
        ("width='100mm' height='50mm' viewBox='0 0 100 50'", [2.0, 49.0]),
        ("width='100mm' viewBox='0 0 200 100'", [1.0, 49.5]),
        ("height='50mm' viewBox='-10 -10 200 100'", [6.0, 44.5]),
        ("width='100%' height='100%' viewBox='0 0 96 96'", [2.0, 95.0].map(|pixels: f64| pixels * 25.4 / 96.0)),
        ("width='100mm' height='100mm' viewBox='0 0 100 50'", [2.0, 74.0]),
        ("width='100mm' height='100mm' viewBox='0 0 100 50' preserveAspectRatio='xMinYMin'", [2.0, 99.0]),
        ("width='100mm' height='100mm' viewBox='0 0 100 50' preserveAspectRatio='xMaxYMax slice'", [-96.0, 98.0]),
        ("width='100mm' height='100mm' viewBox='0 0 100 50' preserveAspectRatio='none'", [2.0, 98.0]),
    ] {
        let points = read(Svg, &format!("<svg {head}><path d='M2 1h1'/></svg>"));
        let [x, y, z] = points[0].at;
        assert!((x - wanted[0]).hypot(y - wanted[1]) < 1e-9 && z == 0.0, "{head}: {x} {y}");
    }
}

#[test]
fn between_outlines_the_pen_is_lifted() {
    let plane = Plane::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.001).unwrap();
    let placement = Placement::new(plane, 1e-5, 0.02).unwrap();
    let svg = "<svg viewBox='0 0 96 96' width='1in'>\n<path d='M0 96h96'/>\n<path d='M0 0h96'/></svg>";
    let points = Svg.read(svg.as_bytes(), &placement).unwrap();
    let rounded: Vec<_> = points
        .iter()
        .map(|it| (it.at.map(|number| (number * 1e4).round() / 1e4 + 0.0), it.is_drawing, it.line))
        .collect();
    let (low, high, side) = (0.0, -0.02, 0.0254);
    assert_eq!(
        rounded,
        [
            ([0.0, high, 0.0], false, 2),
            ([0.0, low, 0.0], false, 2),
            ([side, low, 0.0], true, 2),
            ([side, high, 0.0], false, 3),
            ([0.0, high, side], false, 3),
            ([0.0, low, side], false, 3),
            ([side, low, side], true, 3),
            ([side, high, side], false, 3),
        ]
    );
}

#[test]
fn what_is_not_shown_is_not_drawn() {
    let hidden = "<defs><path d='M9 9h9'/></defs><g display='none'><path d='M9 9h9'/></g><text style='display : none'/>\
        <symbol><circle r='9'/></symbol><title>x</title><x:path xmlns:x='urn:x' d='M9 9h9'/><!-- <path/> -->";
    drawn(&format!("{hidden}<path d='M1 0h1'/>"), &[[1.0, 0.0], [2.0, 0.0]]);
    assert_eq!(
        read(Svg, "<!DOCTYPE svg PUBLIC '-//W3C//DTD SVG 1.1//EN' 'x.dtd'>\n<svg><path d='M1 0h1'/></svg>").len(),
        2
    );
}

#[test]
fn errors_name_the_line() {
    for (text, said) in [
        ("", "line 1: "),
        ("<svg></svg>", "there are no points"),
        ("<html/>", "line 1: not an SVG drawing"),
        ("<svg>\n<path d='M0 0</svg>", "line 2: "),
        ("<svg>\n\n<path d='M0 0L1'/></svg>", "line 3: d: "),
        ("<svg>\n<path d='L1 1'/></svg>", "line 2: d: "),
        ("<svg>\n<path d='M0 0 B1 1'/></svg>", "line 2: d: "),
        ("<svg>\n<polyline points='1 2 3'/></svg>", "line 2: points: a number is missing"),
        ("<svg>\n<polyline points='1 2 x 3'/></svg>", "line 2: points: "),
        ("<svg>\n<circle r='5em'/></svg>", "line 2: r: `5em` has a unit that is not supported"),
        ("<svg>\n<circle r='five'/></svg>", "line 2: r: "),
        ("<svg>\n<g transform='turn(3)'/></svg>", "line 2: transform: "),
        ("<svg>\n<g style='transform: none'/></svg>", "line 2: a transform in a style is not supported"),
        ("<svg>\n<text>a</text></svg>", "line 2: text is not supported: convert it to paths"),
        ("<svg>\n<use href='#a'/></svg>", "line 2: <use> is not supported"),
        ("<svg>\n<svg/></svg>", "line 2: <svg> is not supported"),
        ("<svg>\n<image/></svg>", "line 2: <image> is not supported"),
        ("<svg>\n<path d='M0 0L1e200 0'/></svg>", "line 2: a coordinate is not finite or too large"),
        ("<svg>\n<path d='M0 0Q1e9 9 0 1'/></svg>", "line 2: a curve is too large for the tolerance"),
        ("<svg>\n<circle r='1e9'/></svg>", "line 2: an arc is too large for the tolerance"),
        ("<svg>\n<g transform='scale(1e300)'><circle r='1e10'/></g></svg>", "line 2: an arc is too large"),
        ("<svg viewBox='0 0 0 1'/>", "line 1: viewBox has a negative or zero size"),
        ("<svg width='-1'/>", "line 1: the drawing's width and height must be above zero"),
        ("<!DOCTYPE svg [\n<!ENTITY a 'b'>]><svg/>", "line 2: entities are not supported"),
    ] {
        let error = error(Svg, text);
        assert!(error.starts_with(said), "{text:?}: {error}");
    }
}

#[test]
fn deep_and_many_elements_are_bounded() {
    let depth = 300_000;
    let deep = format!("<svg>{}<path d='M0 0h1'/>{}</svg>", "<g>".repeat(depth), "</g>".repeat(depth));
    assert_eq!(read(Svg, &deep).len(), 2);
    let many = format!("<svg>{}</svg>", "<g/>".repeat(1_000_001));
    assert!(error(Svg, &many).contains("nodes limit reached"));
    // Each curve is small enough, all of them are too much.
    let mut data = String::from("M0 0");
    for _ in 0..20_000 {
        data.push_str("C0 9e5 9e5 9e5 9e5 0S0-9e5 0 0");
    }
    let mut svg = String::new();
    write!(svg, "<svg><path d='{data}'/></svg>").unwrap();
    assert!(error(Svg, &svg).contains("more than 1000000 points"));
    assert!(Svg.read(svg.as_bytes(), &flat(1e6)).is_ok());
}
