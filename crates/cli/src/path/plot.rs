//! A drawing of a path: what is wanted, what can't be reached, and what was.

use std::fmt::Write as _;

use super::{Plan, Plane, Waypoint};

/// How wide and high a drawing is at most, in pixels.
const SIZE: f64 = 800.0;
const MARGIN: f64 = 20.0;
/// What is written below it.
const LEGEND: [(&str, &str); 4] =
    [("drawn", "drawn"), ("travelled", "travelled"), ("reached", "reached"), ("unreachable", "unreachable")];

/// An SVG drawing of a path as it is seen on the plane, with what was reached over what was wanted, and the parts that
/// can't be reached in red.
#[must_use]
pub fn plot(points: &[Waypoint], plan: &Plan, reached: &[Option<[f64; 3]>], plane: &Plane) -> String {
    let unreachable = plan.unreachable.iter().flat_map(|part| &part.points);
    let all = points.iter().map(|it| &it.at).chain(unreachable).chain(reached.iter().flatten());
    let page = Page::around(all.map(|at| plane.seen(*at)));
    let (width, height) = (page.width + 2.0 * MARGIN, page.height + 2.0 * MARGIN);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{:.0}\">\n<style>\n\
         rect {{ fill: #fff }} text {{ font: 13px sans-serif }} path {{ fill: none; stroke-linejoin: round }}\n\
         .drawn {{ stroke: #888; stroke-width: 3 }} .travelled {{ stroke: #bbb; stroke-dasharray: 4 }}\n\
         .reached {{ stroke: #06c }} .unreachable {{ stroke: #d00; stroke-width: 3; stroke-linecap: round }}\n\
         </style>\n<rect width=\"100%\" height=\"100%\"/>\n",
        height + 20.0
    );
    let seen = |at: [f64; 3]| page.at(plane.seen(at));
    for is_drawing in [false, true] {
        let mut data = String::new();
        let mut before: Option<&Waypoint> = None;
        for point in points {
            if let (Some(before), true) = (before, point.is_drawing == is_drawing) {
                // A run that goes on needs no beginning.
                if data.is_empty() || before.is_drawing != is_drawing {
                    let _ = write!(data, "M{}", seen(before.at));
                }
                let _ = write!(data, "L{}", seen(point.at));
            }
            before = Some(point);
        }
        add(&mut svg, if is_drawing { "drawn" } else { "travelled" }, &data);
    }
    let mut data = String::new();
    let mut command = 'M';
    for at in reached {
        match at {
            Some(at) => {
                let _ = write!(data, "{command}{}", seen(*at));
                command = 'L';
            }
            None => command = 'M',
        }
    }
    add(&mut svg, "reached", &data);
    for part in &plan.unreachable {
        let mut data = String::new();
        for (at, command) in part.points.iter().zip(std::iter::once('M').chain(std::iter::repeat('L'))) {
            let _ = write!(data, "{command}{}", seen(*at));
        }
        // A single point is shown by its round ends.
        data.push_str("h0");
        add(&mut svg, "unreachable", &data);
    }
    for ((class, name), x) in LEGEND.into_iter().zip([0.0, 120.0, 240.0, 360.0]) {
        let _ = writeln!(
            svg,
            "<path class=\"{class}\" d=\"M{:.0} {height:.0}h24\"/><text x=\"{:.0}\" y=\"{:.0}\">{name}</text>",
            MARGIN + x,
            MARGIN + x + 30.0,
            height + 4.0
        );
    }
    svg.push_str("</svg>\n");
    svg
}

fn add(svg: &mut String, class: &str, data: &str) {
    if !data.is_empty() {
        let _ = writeln!(svg, "<path class=\"{class}\" d=\"{data}\"/>");
    }
}

/// What is seen, fitted into a drawing.
struct Page {
    left: f64,
    top: f64,
    scale: f64,
    width: f64,
    height: f64,
}

impl Page {
    fn around(points: impl Iterator<Item = [f64; 2]>) -> Self {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let grow = |[least, most]: [f64; 2], number: f64| [least.min(number), most.max(number)];
        let ([left, right], [bottom, top]) =
            points.fold((none, none), |(x, y), [right, up]| (grow(x, right), grow(y, up)));
        let (width, height) = ((right - left).max(0.0), (top - bottom).max(0.0));
        let scale = SIZE / width.max(height).max(1e-9);
        Self { left, top, scale, width: width * scale, height: height * scale }
    }

    fn at(&self, [right, up]: [f64; 2]) -> String {
        let (x, y) = ((right - self.left) * self.scale, (self.top - up) * self.scale);
        format!("{:.2} {:.2}", x + MARGIN, y + MARGIN)
    }
}

#[cfg(test)]
mod tests {
    use super::super::machine::tests::example;
    use super::super::{Plane, Waypoint, plan};
    use super::plot;

    #[test]
    fn all_that_is_to_be_seen() {
        let places =
            [([0.2, 0.4, 0.2], false), ([0.3, 0.4, 0.2], true), ([0.3, 0.4, 0.3], false), ([0.3, 0.9, 0.4], true)];
        let points = places.map(|(at, is_drawing)| Waypoint { at, is_drawing, line: 1 });
        let machine = example();
        let plan = plan(&points, &machine, 1e-3).unwrap();
        let plane = Plane::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 1.0).unwrap();
        let svg = plot(&points, &plan, &[Some(places[0].0), None, Some(places[2].0), Some(places[1].0)], &plane);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let data = |class: &str| {
            let mut all = document.descendants().filter(|node| node.attribute("class") == Some(class));
            all.find_map(|node| node.attribute("d")).unwrap().to_owned()
        };
        assert_eq!(data("drawn"), "M20.00 820.00L420.00 820.00M420.00 420.00L420.00 20.00");
        assert_eq!(data("travelled"), "M420.00 820.00L420.00 420.00");
        assert_eq!(data("reached"), "M20.00 820.00M420.00 420.00L420.00 820.00");
        assert!(data("unreachable").starts_with("M420.00 ") && data("unreachable").ends_with("L420.00 20.00h0"));
        // Even nothing is a drawing.
        roxmltree::Document::parse(&plot(&[], &super::Plan::default(), &[], &plane)).unwrap();
    }
}
