//! Leaves points out that a path does not need.

use super::Waypoint;
use super::vector::off;

/// Points that are simplified together. How long that takes may grow with the square of their number, so a longer run is
/// cut into pieces.
const PIECE: usize = 1024;

/// Leaves out the points that lie within `tolerance` of the segments between those that are left (Ramer, Douglas,
/// Peucker). What is travel stays travel; where one becomes the other, the point stays.
#[must_use]
pub fn simplify(points: &[Waypoint], tolerance: f64) -> Vec<Waypoint> {
    let mut kept = Vec::new();
    kept.extend(points.first());
    let mut rest = points;
    while let [_, next, ..] = rest {
        // A run has the point that it begins from, and all that are reached in the same way.
        let run = 1 + rest.iter().skip(1).take(PIECE).take_while(|it| it.is_drawing == next.is_drawing).count();
        simplify_run(rest.get(..run).unwrap_or_default(), tolerance, &mut kept);
        rest = rest.get(run - 1..).unwrap_or_default();
    }
    kept
}

/// Adds what is left of a run, but for its first point.
fn simplify_run(run: &[Waypoint], tolerance: f64, kept: &mut Vec<Waypoint>) {
    let mut waiting = vec![run];
    while let Some(run) = waiting.pop() {
        let [first, inner @ .., last] = run else { continue };
        let distances = inner.iter().map(|point| off(point.at, first.at, last.at)).enumerate();
        let farthest = distances.max_by(|(_, a), (_, b)| a.total_cmp(b));
        match farthest {
            Some((place, distance)) if distance > tolerance => {
                let place = place + 1;
                waiting.extend(run.get(place..));
                waiting.extend(run.get(..=place));
            }
            _ => kept.push(*last),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::vector::off;
    use super::{PIECE, Waypoint, simplify};

    fn point(at: [f64; 3], is_drawing: bool, line: usize) -> Waypoint {
        Waypoint { at, is_drawing, line }
    }

    #[test]
    fn what_is_straight_needs_two_points() {
        let points: Vec<_> = (0..100).map(|number| point([f64::from(number), 0.0, 0.0], number > 0, 1)).collect();
        assert_eq!(simplify(&points, 0.1), [points[0], points[99]]);
        assert_eq!(simplify(&[], 0.1), []);
        assert_eq!(simplify(&points[..1], 0.1), points[..1]);
    }

    #[test]
    fn a_way_there_and_back_keeps_its_turn() {
        let points: Vec<_> = [0.0, 5.0, 10.0, 5.0, 0.0].iter().map(|x| point([*x, 0.0, 0.0], true, 1)).collect();
        assert_eq!(simplify(&points, 0.1), [points[0], points[2], points[4]]);
    }

    #[test]
    fn long_runs_are_cut_into_pieces() {
        let points: Vec<_> = (0..2500_u32).map(|number| point([f64::from(number), 0.0, 0.0], true, 1)).collect();
        assert_eq!(simplify(&points, 0.1), [points[0], points[PIECE], points[2 * PIECE], points[2499]]);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn all_that_is_left_out_lies_within_the_tolerance(
            raw in prop::collection::vec(([-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], prop::bool::weighted(0.8)), 1..200),
            tolerance in 0.01..1.0_f64,
        ) {
            let points: Vec<_> =
                (1..).zip(raw).map(|(line, (at, is_drawing))| point(at, is_drawing, line)).collect();
            let left = simplify(&points, tolerance);
            prop_assert_eq!(left.first(), points.first());
            prop_assert_eq!(left.last(), points.last());
            // The lines count the points, so they say which were left out between two.
            for pair in left.windows(2) {
                prop_assert!(pair[0].line < pair[1].line);
                for point in &points[pair[0].line..pair[1].line - 1] {
                    prop_assert!(off(point.at, pair[0].at, pair[1].at) <= tolerance);
                    prop_assert_eq!(point.is_drawing, pair[1].is_drawing);
                }
            }
        }
    }
}
