//! Arcs of circles in the plane of x and y, on which z goes along evenly.

use std::f64::consts::{FRAC_PI_4, TAU};

/// The most segments of one arc.
const SEGMENTS_MAX: f64 = 100_000.0;

pub(super) struct Arc {
    from: [f64; 3],
    to: [f64; 3],
    centre: [f64; 2],
    /// Distances of the ends from the centre, which files round.
    radii: [f64; 2],
    begin: f64,
    /// Above zero counterclockwise.
    sweep: f64,
}

/// The centre of the arc that R gives: of the two, the one with the shorter way, or for R below zero the longer.
pub(super) fn centre_of(
    [x, y, _]: [f64; 3],
    [to_x, to_y, _]: [f64; 3],
    r: f64,
    clockwise: bool,
) -> Result<[f64; 2], &'static str> {
    let (dx, dy) = (to_x - x, to_y - y);
    let half = dx.hypot(dy) / 2.0;
    if half == 0.0 {
        return Err("an arc by R needs two different ends");
    }
    if !is_near(half.max(r.abs()), r.abs()) {
        return Err("the ends of the arc are farther apart than R allows");
    }
    let away = (r * r - half * half).max(0.0).sqrt() / (2.0 * half);
    let side = if clockwise == (r > 0.0) { away } else { -away };
    Ok([x + dx / 2.0 + dy * side, y + dy / 2.0 - dx * side])
}

/// To within what files round: a tenth of a percent, or 0.01 mm.
fn is_near(one: f64, other: f64) -> bool {
    (one - other).abs() <= (0.001 * other).max(0.01)
}

impl Arc {
    pub(super) fn new(from: [f64; 3], to: [f64; 3], centre: [f64; 2], clockwise: bool) -> Result<Self, &'static str> {
        let [cx, cy] = centre;
        let seen = |[x, y, _]: [f64; 3]| ((x - cx).hypot(y - cy), (y - cy).atan2(x - cx));
        let ((first, begin), (last, end)) = (seen(from), seen(to));
        if !is_near(last, first) {
            return Err("the ends of the arc have different distances from its centre");
        }
        if first == 0.0 || last == 0.0 {
            return Err("the ends of the arc lie at its centre");
        }
        let turn = (end - begin).rem_euclid(TAU);
        // Where both ends are the same, it is a whole circle.
        let is_whole = !(1e-9..=TAU - 1e-9).contains(&turn);
        let sweep = match (is_whole, clockwise) {
            (true, false) => TAU,
            (true, true) => -TAU,
            (false, false) => turn,
            (false, true) => turn - TAU,
        };
        Ok(Self { from, to, centre, radii: [first, last], begin, sweep })
    }

    /// The ends of segments that are nowhere farther from the arc than the tolerance.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "above zero, and bounded")]
    pub(super) fn flattened(&self, tolerance: f64) -> Result<impl Iterator<Item = [f64; 3]>, &'static str> {
        let [first, last] = self.radii;
        let angle = 2.0 * (1.0 - tolerance / first.max(last)).max(0.0).acos();
        let count = (self.sweep.abs() / angle.min(FRAC_PI_4)).ceil();
        if count.is_nan() || count > SEGMENTS_MAX {
            return Err("the arc is too large for the tolerance");
        }
        let count = count as u32;
        Ok((1..=count).map(move |number| self.at(f64::from(number) / f64::from(count))))
    }

    fn at(&self, part: f64) -> [f64; 3] {
        if part >= 1.0 {
            return self.to;
        }
        let ([_, _, z], [_, _, to_z], [cx, cy], [first, last]) = (self.from, self.to, self.centre, self.radii);
        let (sine, cosine) = (self.begin + self.sweep * part).sin_cos();
        let radius = first + (last - first) * part;
        [cx + radius * cosine, cy + radius * sine, z + (to_z - z) * part]
    }
}
