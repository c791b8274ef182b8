//! Puts down the points of a path, as one draws it.

use super::{Error, POINTS_MAX, Placement, Waypoint};

/// A pen that is led over a plane.
#[derive(Debug)]
pub struct Pen {
    placement: Placement,
    /// Where it is, in the file's unit.
    at: Option<[f64; 3]>,
    points: Vec<Waypoint>,
}

impl Pen {
    /// A pen that is nowhere yet.
    #[must_use]
    pub fn new(placement: Placement) -> Self {
        Self { placement, at: None, points: Vec::new() }
    }

    /// Begins a stroke there: travels above the plane, as high as the placement says.
    ///
    /// # Errors
    ///
    /// A number that is not finite, too many points. So do the others.
    pub fn start(&mut self, at: [f64; 3], line: usize) -> Result<(), Error> {
        if self.at == Some(at) {
            return Ok(());
        }
        let lift = self.placement.file_lift();
        if lift > 0.0 {
            self.lift(line)?;
            let [x, y, z] = at;
            self.travel([x, y, z + lift], line)?;
        }
        self.travel(at, line)
    }

    /// Draws a straight line.
    ///
    /// # Errors
    ///
    /// See [`start`](Self::start).
    pub fn draw(&mut self, at: [f64; 3], line: usize) -> Result<(), Error> {
        self.put(at, true, line)
    }

    /// Goes there in a straight line, without drawing.
    ///
    /// # Errors
    ///
    /// See [`start`](Self::start).
    pub fn travel(&mut self, at: [f64; 3], line: usize) -> Result<(), Error> {
        self.put(at, false, line)
    }

    /// Lifts it for the last time.
    ///
    /// # Errors
    ///
    /// There is nothing.
    pub fn finish(mut self) -> Result<Vec<Waypoint>, Error> {
        let line = self.points.last().map(|last| last.line).ok_or_else(|| Error::new("there are no points"))?;
        if self.placement.file_lift() > 0.0 {
            self.lift(line)?;
        }
        Ok(self.points)
    }

    fn lift(&mut self, line: usize) -> Result<(), Error> {
        let Some([x, y, z]) = self.at else { return Ok(()) };
        self.travel([x, y, z + self.placement.file_lift()], line)
    }

    fn put(&mut self, at: [f64; 3], is_drawing: bool, line: usize) -> Result<(), Error> {
        if self.at == Some(at) {
            return Ok(());
        }
        let place = self.placement.plane().place(at);
        // So that their squares, and differences of those, are finite too.
        if !place.iter().all(|number| number.abs() < 1e100) {
            return Err(Error::at(line, "a coordinate is not finite or too large"));
        }
        if self.points.len() >= POINTS_MAX {
            return Err(Error::at(line, format!("the path has more than {POINTS_MAX} points")));
        }
        self.at = Some(at);
        self.points.push(Waypoint { at: place, is_drawing, line });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{POINTS_MAX, Plane};
    use super::{Pen, Placement};

    fn pen(lift: f64) -> Pen {
        let plane = Plane::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.5).unwrap();
        Pen::new(Placement::new(plane, 0.1, lift).unwrap())
    }

    #[test]
    fn strokes_are_joined_by_travel_above_the_plane() {
        let mut pen = pen(3.0);
        for (number, x) in [(1, 0.0), (2, 10.0)] {
            pen.start([x, 0.0, 0.0], number).unwrap();
            pen.draw([x, 4.0, 0.0], number).unwrap();
        }
        let points: Vec<_> = pen.finish().unwrap().iter().map(|it| (it.at, it.is_drawing, it.line)).collect();
        assert_eq!(
            points,
            [
                ([0.0, 0.0, 3.0], false, 1),
                ([0.0, 0.0, 0.0], false, 1),
                ([0.0, 2.0, 0.0], true, 1),
                ([0.0, 2.0, 3.0], false, 2),
                ([5.0, 0.0, 3.0], false, 2),
                ([5.0, 0.0, 0.0], false, 2),
                ([5.0, 2.0, 0.0], true, 2),
                ([5.0, 2.0, 3.0], false, 2),
            ]
        );
    }

    #[test]
    fn what_can_not_be_drawn_is_refused() {
        assert_eq!(pen(0.0).finish().unwrap_err().to_string(), "there are no points");
        for number in [f64::NAN, f64::INFINITY, 1e200] {
            let error = pen(0.0).draw([0.0, number, 0.0], 7).unwrap_err();
            assert_eq!(error.to_string(), "line 7: a coordinate is not finite or too large");
        }
        let mut pen = pen(0.0);
        for number in 0..u32::try_from(POINTS_MAX).unwrap() {
            pen.draw([f64::from(number), 0.0, 0.0], 1).unwrap();
        }
        assert!(pen.draw([-1.0, 0.0, 0.0], 8).unwrap_err().to_string().contains("more than 1000000 points"));
    }
}
