//! Outlines of lines and Bézier curves.

use kurbo::{Arc, PathEl, Point, SvgArc, Vec2};
use svgtypes::{PathParser, PathSegment};

use super::LONGEST;

/// An outline that is being made, before its transform.
pub(super) struct Outline {
    elements: Vec<PathEl>,
    /// How far arcs may be from their curves.
    tolerance: f64,
    begun: Point,
    at: Point,
    /// The control point that a smooth curve mirrors, and whether it is of a cubic curve.
    control: Option<(Point, bool)>,
}

impl Outline {
    pub(super) fn new(tolerance: f64) -> Self {
        Self { elements: Vec::new(), tolerance, begun: Point::ORIGIN, at: Point::ORIGIN, control: None }
    }

    pub(super) fn finish(self) -> Vec<PathEl> {
        self.elements
    }

    fn move_to(&mut self, to: Point) {
        self.elements.push(PathEl::MoveTo(to));
        (self.begun, self.at) = (to, to);
    }

    fn add(&mut self, element: PathEl) {
        // What follows a closed outline begins where that did.
        if matches!(self.elements.last(), None | Some(PathEl::ClosePath)) {
            self.move_to(self.at);
        }
        self.elements.push(element);
        self.at = element.end_point().unwrap_or(self.begun);
    }

    pub(super) fn close(&mut self) {
        if !self.elements.is_empty() {
            self.add(PathEl::ClosePath);
        }
    }

    /// Points that are joined by lines.
    pub(super) fn line(&mut self, points: impl IntoIterator<Item = Point>) {
        for point in points {
            if self.elements.is_empty() { self.move_to(point) } else { self.add(PathEl::LineTo(point)) }
        }
    }

    pub(super) fn ellipse(&mut self, Point { x, y }: Point, [rx, ry]: [f64; 2]) -> Result<(), String> {
        // SVG draws nothing for such, and so for rectangles.
        if rx <= 0.0 || ry <= 0.0 {
            return Ok(());
        }
        let (right, left) = (Point::new(x + rx, y), Point::new(x - rx, y));
        self.move_to(right);
        for to in [left, right] {
            self.arc(to, [rx, ry], 0.0, [false, true])?;
        }
        self.close();
        Ok(())
    }

    pub(super) fn rect(
        &mut self,
        Point { x, y }: Point,
        [width, height]: [f64; 2],
        [rx, ry]: [f64; 2],
    ) -> Result<(), String> {
        if width <= 0.0 || height <= 0.0 {
            return Ok(());
        }
        let (rx, ry) = (rx.clamp(0.0, width / 2.0), ry.clamp(0.0, height / 2.0));
        let (right, bottom) = (x + width, y + height);
        self.move_to(Point::new(x + rx, y));
        for [side, corner] in [
            [(right - rx, y), (right, y + ry)],
            [(right, bottom - ry), (right - rx, bottom)],
            [(x + rx, bottom), (x, bottom - ry)],
            [(x, y + ry), (x + rx, y)],
        ] {
            self.add(PathEl::LineTo(side.into()));
            if rx > 0.0 && ry > 0.0 {
                self.arc(corner.into(), [rx, ry], 0.0, [false, true])?;
            }
        }
        self.close();
        Ok(())
    }

    fn arc(
        &mut self,
        to: Point,
        [rx, ry]: [f64; 2],
        degrees: f64,
        [large_arc, sweep]: [bool; 2],
    ) -> Result<(), String> {
        let from = self.at;
        let way = from.distance(to);
        let largest = rx.abs().max(ry.abs()).max(way);
        if largest.is_nan() || largest > LONGEST * self.tolerance {
            return Err("an arc is too large for the tolerance".into());
        }
        let svg_arc = SvgArc { from, to, radii: Vec2::new(rx, ry), x_rotation: degrees.to_radians(), large_arc, sweep };
        // What is smaller than any length that is drawn leaves nothing to compute with.
        match Arc::from_svg_arc(&svg_arc).filter(|_| way > 1e-9 * largest) {
            Some(arc) => {
                let mut curves = Vec::new();
                arc.to_cubic_beziers(self.tolerance, |a, b, c| curves.push((a, b, c)));
                // The last one ends where the arc does, and not only nearly.
                if let Some((_, _, end)) = curves.last_mut() {
                    *end = to;
                }
                for (a, b, c) in curves {
                    self.add(PathEl::CurveTo(a, b, c));
                }
            }
            None => self.add(PathEl::LineTo(to)),
        }
        Ok(())
    }

    /// What the attribute `d` of a path says.
    pub(super) fn data(&mut self, data: &str) -> Result<(), String> {
        for segment in PathParser::from(data) {
            self.segment(segment.map_err(|error| format!("d: {error}"))?)?;
        }
        Ok(())
    }

    fn segment(&mut self, segment: PathSegment) -> Result<(), String> {
        let from = self.at;
        let place = |x, y| if segment.is_abs() { Point::new(x, y) } else { from + (x, y) };
        // The mirrored control point of the curve before, if that is of the same kind.
        let mirrored = |control: Option<(Point, bool)>, cubic| match control {
            Some((point, is_cubic)) if is_cubic == cubic => from + (from - point),
            _ => from,
        };
        let before = self.control.take();
        match segment {
            PathSegment::MoveTo { x, y, .. } => self.move_to(place(x, y)),
            PathSegment::LineTo { x, y, .. } => self.add(PathEl::LineTo(place(x, y))),
            PathSegment::HorizontalLineTo { abs, x } => {
                self.add(PathEl::LineTo(Point::new(if abs { x } else { from.x + x }, from.y)));
            }
            PathSegment::VerticalLineTo { abs, y } => {
                self.add(PathEl::LineTo(Point::new(from.x, if abs { y } else { from.y + y })));
            }
            PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. } => self.cubic(place(x1, y1), place(x2, y2), place(x, y)),
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                self.cubic(mirrored(before, true), place(x2, y2), place(x, y));
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => self.quadratic(place(x1, y1), place(x, y)),
            PathSegment::SmoothQuadratic { x, y, .. } => self.quadratic(mirrored(before, false), place(x, y)),
            PathSegment::EllipticalArc { rx, ry, x_axis_rotation, large_arc, sweep, x, y, .. } => {
                self.arc(place(x, y), [rx, ry], x_axis_rotation, [large_arc, sweep])?;
            }
            PathSegment::ClosePath { .. } => self.close(),
        }
        Ok(())
    }

    fn cubic(&mut self, first: Point, second: Point, to: Point) {
        self.add(PathEl::CurveTo(first, second, to));
        self.control = Some((second, true));
    }

    fn quadratic(&mut self, control: Point, to: Point) {
        self.add(PathEl::QuadTo(control, to));
        self.control = Some((control, false));
    }
}
