//! The outlines of a drawing: paths and basic shapes with their transforms, in millimetres, x to the right and y up from
//! the lower left corner of the page. Whether they are stroked or filled, and how, makes no difference.

mod outline;
mod page;

use kurbo::{Affine, PathEl, Point};
use roxmltree::{Document, Node, ParsingOptions};
use svgtypes::{LengthUnit, NumberListParser, TransformListParser, TransformListToken};

use super::{Error, Pen, Placement, Waypoint};
use outline::Outline;

const NAMESPACE: &str = "http://www.w3.org/2000/svg";
/// The most elements, attributes and texts of a file.
const NODES_MAX: u32 = 1_000_000;
/// How many tolerances large a curve may be, so that it is flattened to some ten thousand points at most.
const LONGEST: f64 = 1e8;
/// Elements that draw nothing where they stand.
const SILENT: [&str; 18] = [
    "defs",
    "symbol",
    "clipPath",
    "mask",
    "marker",
    "pattern",
    "linearGradient",
    "radialGradient",
    "filter",
    "style",
    "script",
    "metadata",
    "title",
    "desc",
    "view",
    "animate",
    "animateTransform",
    "set",
];

pub(super) fn read(text: &str, placement: &Placement) -> Result<Vec<Waypoint>, Error> {
    let lines = Lines::of(text);
    if let Some(place) = text.find("<!ENTITY") {
        return Err(Error::at(lines.line(place), "entities are not supported"));
    }
    let options = ParsingOptions { allow_dtd: true, nodes_limit: NODES_MAX, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let line = usize::try_from(error.pos().row).unwrap_or(usize::MAX);
        let message = error.to_string();
        // It says the place itself, at the end.
        Error::at(line, message.split(" at ").next().unwrap_or(&message))
    })?;
    let root = document.root_element();
    if !is_svg(&root) || root.tag_name().name() != "svg" {
        return Err(Error::at(lines.line(root.range().start), "not an SVG drawing"));
    }
    let page = page::to_page(&root).map_err(|message| Error::at(lines.line(root.range().start), message))?;
    let mut drawing = Drawing { pen: Pen::new(*placement), tolerance: placement.file_tolerance() };
    // Not by recursion, for which a file may be nested too deep.
    let mut waiting = vec![(root, page)];
    while let Some((node, outer)) = waiting.pop() {
        let line = lines.line(node.range().start);
        let refused = |message: String| Error::at(line, message);
        let to_page = if node == root { outer } else { outer * transform(&node).map_err(refused)? };
        if let Some(outline) = shape(&node, drawing.local_tolerance(to_page)).map_err(refused)? {
            drawing.trace(&outline, to_page, line)?;
        } else {
            let inner = waiting.len();
            waiting.extend(node.children().filter(is_shown).map(|child| (child, to_page)));
            waiting.get_mut(inner..).unwrap_or_default().reverse();
        }
    }
    drawing.pen.finish()
}

fn is_svg(node: &Node) -> bool {
    node.is_element() && node.tag_name().namespace().is_none_or(|namespace| namespace == NAMESPACE)
}

fn is_shown(node: &Node) -> bool {
    is_svg(node)
        && !SILENT.contains(&node.tag_name().name())
        && node.attribute("display") != Some("none")
        && styled(node, "display") != Some("none")
}

/// What the attribute `style` says of a property.
fn styled<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    let mut properties = node.attribute("style")?.split(';').filter_map(|property| property.split_once(':'));
    properties.find_map(|(property, value)| (property.trim() == name).then_some(value.trim()))
}

/// The outline of an element; `None` of one that only has others in it.
fn shape(node: &Node, tolerance: f64) -> Result<Option<Vec<PathEl>>, String> {
    let number = |name| length(node, name).map(Option::unwrap_or_default);
    let point = |x, y| Ok::<_, String>(Point::new(number(x)?, number(y)?));
    let mut outline = Outline::new(tolerance);
    match node.tag_name().name() {
        "svg" if node.parent_element().is_none() => return Ok(None),
        "g" | "a" => return Ok(None),
        "path" => outline.data(node.attribute("d").unwrap_or_default())?,
        "line" => outline.line([point("x1", "y1")?, point("x2", "y2")?]),
        name @ ("polyline" | "polygon") => {
            let text = node.attribute("points").unwrap_or_default();
            let numbers = NumberListParser::from(text).collect::<Result<Vec<_>, _>>();
            let numbers = numbers.map_err(|error| format!("points: {error}"))?;
            let (points, []) = numbers.as_chunks() else { return Err("points: a number is missing".into()) };
            outline.line(points.iter().map(|&[x, y]| Point::new(x, y)));
            if name == "polygon" {
                outline.close();
            }
        }
        "circle" => outline.ellipse(point("cx", "cy")?, [number("r")?; 2])?,
        "ellipse" => outline.ellipse(point("cx", "cy")?, [number("rx")?, number("ry")?])?,
        "rect" => {
            // Of the radii, one that is not given is like the other.
            let (rx, ry) = (length(node, "rx")?, length(node, "ry")?);
            let radii = [rx.or(ry).unwrap_or_default(), ry.or(rx).unwrap_or_default()];
            outline.rect(point("x", "y")?, [number("width")?, number("height")?], radii)?;
        }
        "text" | "tspan" | "flowRoot" => return Err("text is not supported: convert it to paths".into()),
        "use" => return Err("<use> is not supported: put in its place what it refers to".into()),
        other => return Err(format!("<{other}> is not supported")),
    }
    Ok(Some(outline.finish()))
}

fn transform(node: &Node) -> Result<Affine, String> {
    if styled(node, "transform").is_some() {
        return Err("a transform in a style is not supported: make it an attribute".into());
    }
    let mut list = TransformListParser::from(node.attribute("transform").unwrap_or_default());
    list.try_fold(Affine::IDENTITY, |all, token| {
        let token = token.map_err(|error| format!("transform: {error}"))?;
        Ok(all
            * match token {
                TransformListToken::Matrix { a, b, c, d, e, f } => Affine::new([a, b, c, d, e, f]),
                TransformListToken::Translate { tx, ty } => Affine::translate((tx, ty)),
                TransformListToken::Scale { sx, sy } => Affine::scale_non_uniform(sx, sy),
                TransformListToken::Rotate { angle } => Affine::rotate(angle.to_radians()),
                TransformListToken::SkewX { angle } => Affine::skew(angle.to_radians().tan(), 0.0),
                TransformListToken::SkewY { angle } => Affine::skew(0.0, angle.to_radians().tan()),
            })
    })
}

/// A length in pixels, of which an inch has 96.
fn length(node: &Node, name: &str) -> Result<Option<f64>, String> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let length: svgtypes::Length = text.trim().parse().map_err(|error| format!("{name}: {error}"))?;
    let pixels = match length.unit {
        LengthUnit::None | LengthUnit::Px => 1.0,
        LengthUnit::In => 96.0,
        LengthUnit::Cm => 96.0 / 2.54,
        LengthUnit::Mm => 96.0 / 25.4,
        LengthUnit::Pt => 96.0 / 72.0,
        LengthUnit::Pc => 16.0,
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => {
            return Err(format!("{name}: `{text}` has a unit that is not supported"));
        }
    };
    Ok(Some(length.number * pixels))
}

struct Drawing {
    pen: Pen,
    tolerance: f64,
}

impl Drawing {
    /// The part of the tolerance that arcs have until they are Bézier curves, as an outline is before its transform.
    fn local_tolerance(&self, to_page: Affine) -> f64 {
        let [a, b, c, d, ..] = to_page.as_coeffs();
        self.tolerance / 2.0 / (a * a + b * b + c * c + d * d).sqrt()
    }

    fn trace(&mut self, outline: &[PathEl], to_page: Affine, line: usize) -> Result<(), Error> {
        let (mut begun, mut at) = (Point::ORIGIN, Point::ORIGIN);
        // One after the other, so that the first error ends it.
        for element in outline.iter().map(|element| to_page * *element) {
            match element {
                PathEl::MoveTo(to) => {
                    begun = to;
                    self.pen.start([to.x, to.y, 0.0], line)?;
                }
                PathEl::ClosePath => self.pen.draw([begun.x, begun.y, 0.0], line)?,
                curve => self.flatten(at, curve, line)?,
            }
            at = element.end_point().unwrap_or(begun);
        }
        Ok(())
    }

    fn flatten(&mut self, from: Point, curve: PathEl, line: usize) -> Result<(), Error> {
        let (PathEl::LineTo(c) | PathEl::QuadTo(_, c) | PathEl::CurveTo(_, _, c)) = curve else { return Ok(()) };
        let (a, b) = match curve {
            PathEl::QuadTo(a, _) => (a, a),
            PathEl::CurveTo(a, b, _) => (a, b),
            _ => (c, c),
        };
        let size = [a, b, c].into_iter().map(|point| point.distance(from)).fold(0.0, f64::max);
        // A NaN is in one of the points, and refused with them.
        if size > LONGEST * self.tolerance && !matches!(curve, PathEl::LineTo(_)) {
            return Err(Error::at(line, "a curve is too large for the tolerance"));
        }
        let mut result = Ok(());
        kurbo::flatten([PathEl::MoveTo(from), curve], self.tolerance / 2.0, |element| {
            if let (PathEl::LineTo(to), Ok(())) = (element, &result) {
                result = self.pen.draw([to.x, to.y, 0.0], line);
            }
        });
        result
    }
}

/// Where the lines of a text begin.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        Self(text.match_indices('\n').map(|(place, _)| place).collect())
    }

    /// The number of the line that has this byte.
    fn line(&self, place: usize) -> usize {
        1 + self.0.partition_point(|end| *end < place)
    }
}

#[cfg(test)]
mod tests;
