//! What the robot has to do to trace a path, and which parts of it it can't.

use serde::Serialize;

use super::vector::{between, distance, off};
use super::{Error, Machine, POINTS_MAX, Reason, Waypoint};

/// Parts that the machine's size is cut into, to look whether it can be everywhere on a segment.
const FINENESS: f64 = 100.0;
/// The most poses that are looked at.
const LOOKS_MAX: u32 = 2_000_000;
/// The most parts that are unreachable, each for a reason of its own.
const PARTS_MAX: usize = 10_000;
/// How often a motion is halved, at most, until it is straight enough.
const HALVINGS: u32 = 16;

/// A point that the robot is to move to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Target {
    /// Where the platform is then.
    pub at: [f64; 3],
    /// The displacements for that.
    pub displacements: [f32; 3],
    /// Whether the way to it is part of the drawing.
    pub is_drawing: bool,
    /// The line of the file.
    pub line: usize,
}

/// A part of the path where the platform can't be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unreachable {
    /// Its course: the first and the last point of it that were looked at, and the path's between.
    pub points: Vec<[f64; 3]>,
    /// The file's lines that it is part of: the first and the last.
    pub lines: [usize; 2],
    /// Why not; where an arm would have to go too far, how far at worst.
    pub reason: Reason,
}

/// What there is to do.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Plan {
    /// Where to move, one after the other. Where parts are unreachable, those between them are missing.
    pub targets: Vec<Target>,
    /// The parts that can't be reached.
    pub unreachable: Vec<Unreachable>,
    /// The length of what is drawn.
    pub drawn: f64,
    /// The length of what is travelled between, from the first point on.
    pub travelled: f64,
}

/// Looks whether the platform can be everywhere on a path, and adds targets until the robot, whose arms move in
/// proportion, keeps to it to within `tolerance`.
///
/// # Errors
///
/// The path is so long that it would take too many looks, or it is not known how far the arms can go.
pub fn plan(points: &[Waypoint], machine: &Machine, tolerance: f64) -> Result<Plan, Error> {
    if !machine.has_limits() {
        return Err(Error::new("a path needs the geometry to have each arm's min and max"));
    }
    let mut planner =
        Planner { machine, tolerance, plan: Plan::default(), is_reachable: true, is_between: false, looks: 0 };
    let mut before: Option<Waypoint> = None;
    for point in points {
        match before {
            None => planner.first(*point),
            Some(before) => planner.segment(before, *point)?,
        }
        before = Some(*point);
    }
    Ok(planner.plan)
}

struct Planner<'a> {
    machine: &'a Machine,
    tolerance: f64,
    plan: Plan,
    /// Whether the point that was looked at last can be reached.
    is_reachable: bool,
    /// Whether it is one that only looking has made.
    is_between: bool,
    looks: u32,
}

impl Planner<'_> {
    fn first(&mut self, point: Waypoint) {
        if let Some(displacements) = self.look(point.at, [point.line; 2], false) {
            self.add(point.at, displacements, point);
        }
    }

    fn segment(&mut self, from: Waypoint, to: Waypoint) -> Result<(), Error> {
        let length = distance(from.at, to.at);
        *(if to.is_drawing { &mut self.plan.drawn } else { &mut self.plan.travelled }) += length;
        let start = if self.is_reachable { self.plan.targets.last().copied() } else { None };
        let parts = (length / self.machine.size() * FINENESS).ceil().max(1.0);
        if f64::from(self.looks) + parts > f64::from(LOOKS_MAX) {
            return Err(Error::at(to.line, "the path is too long for a machine of this size"));
        }
        if self.plan.unreachable.len() > PARTS_MAX {
            return Err(Error::at(to.line, format!("more than {PARTS_MAX} parts of the path are unreachable")));
        }
        let mut is_straight = start.is_some();
        let parts_before_the_last = (1_u32..).map(f64::from).take_while(|number| *number < parts);
        for number in parts_before_the_last {
            is_straight &= self.look(between(from.at, to.at, number / parts), [from.line, to.line], true).is_some();
        }
        let Some(displacements) = self.look(to.at, [from.line, to.line], false) else { return Ok(()) };
        if let Some(start) = start.filter(|_| is_straight) {
            return self.motion(start, to, displacements);
        }
        self.add(to.at, displacements, to);
        Ok(())
    }

    /// The displacements of a pose, or a note of why there are none.
    fn look(&mut self, at: [f64; 3], lines: [usize; 2], is_between: bool) -> Option<[f32; 3]> {
        self.looks += 1;
        let result = self.machine.displacements(at);
        let was_reachable = std::mem::replace(&mut self.is_reachable, result.is_ok());
        let was_between = std::mem::replace(&mut self.is_between, is_between);
        let reason = match result {
            Ok(displacements) => return Some(displacements),
            Err(reason) => reason,
        };
        let [first, last] = lines;
        match self.plan.unreachable.last_mut() {
            Some(part) if !was_reachable && part.reason.is_like(&reason) => {
                let [begun, ended] = part.lines;
                part.lines = [begun.min(first), ended.max(last)];
                if was_between && part.points.len() > 1 {
                    part.points.pop();
                }
                part.points.push(at);
                if reason.excess() > part.reason.excess() {
                    part.reason = reason;
                }
            }
            _ => self.plan.unreachable.push(Unreachable { points: vec![at], lines, reason }),
        }
        None
    }

    /// Adds the targets of a segment, halved until the motion between two of them is straight enough.
    fn motion(&mut self, start: Target, end: Waypoint, displacements: [f32; 3]) -> Result<(), Error> {
        let mut from = start;
        let mut waiting = vec![(end.at, displacements, HALVINGS)];
        while let Some((to, displacements, halvings)) = waiting.pop() {
            let middle = between(from.at, to, 0.5);
            // It was looked at closely, so that there is nothing new to say about a middle without a pose.
            if halvings > 0
                && !self.is_straight(&from, to, displacements)
                && let Ok(half) = self.machine.displacements(middle)
            {
                waiting.push((to, displacements, halvings - 1));
                waiting.push((middle, half, halvings - 1));
            } else {
                if self.plan.targets.len() >= POINTS_MAX {
                    return Err(Error::at(
                        end.line,
                        format!("the robot would have more than {POINTS_MAX} moves to make"),
                    ));
                }
                self.add(to, displacements, end);
                from = Target { at: to, displacements, ..from };
            }
        }
        Ok(())
    }

    /// Whether the robot stays near a segment when its arms move in proportion.
    #[expect(clippy::many_single_char_names, reason = "three arms, twice")]
    fn is_straight(&self, from: &Target, to: [f64; 3], displacements: [f32; 3]) -> bool {
        [0.25, 0.5, 0.75].into_iter().all(|part| {
            let ([a, b, c], [x, y, z]) = (from.displacements, displacements);
            let on_the_way = [a + (x - a) * part, b + (y - b) * part, c + (z - c) * part];
            self.machine.pose(on_the_way).is_some_and(|at| off(at.map(f64::from), from.at, to) <= self.tolerance)
        })
    }

    fn add(&mut self, at: [f64; 3], displacements: [f32; 3], of: Waypoint) {
        self.plan.targets.push(Target { at, displacements, is_drawing: of.is_drawing, line: of.line });
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::machine::tests::example;
    use super::super::vector::off;
    use super::super::{Reason, Waypoint};
    use super::{Plan, plan};

    fn points(places: &[[f64; 3]]) -> Vec<Waypoint> {
        (1..).zip(places).map(|(line, at)| Waypoint { at: *at, is_drawing: line > 1, line }).collect()
    }

    fn planned(places: &[[f64; 3]], tolerance: f64) -> Plan {
        plan(&points(places), &example(), tolerance).unwrap()
    }

    #[test]
    fn a_part_that_lies_between_two_points_is_found() {
        // Over the top of what the arms reach, from one side to the other.
        let plan = planned(&[[0.2, 0.6, 0.25], [0.2, 0.9, 0.25], [0.2, 0.5, 0.25]], 1e-4);
        let [part] = plan.unreachable.as_slice() else { panic!("{plan:?}") };
        assert_eq!(part.lines, [1, 3]);
        assert!(
            matches!(part.reason, Reason::Arm { arm: 'A' | 'C', displacement, limit: 600.0 } if displacement > 690.0)
        );
        let [first, [_, top, _], last] = part.points.as_slice() else { panic!("{part:?}") };
        assert!(first[1] > 0.7 && *top == 0.9 && last[1] > 0.7, "{part:?}");
        assert!((plan.drawn - 0.7).abs() < 1e-9 && plan.travelled == 0.0);
        // Both ends can be reached; between them the legs would have to be too short.
        let plan = planned(&[[0.0, 0.155, 0.25], [0.2, 0.205, 0.25]], 1e-4);
        assert_eq!(plan.targets.len(), 2, "{plan:?}");
        assert!(!plan.unreachable.is_empty() && plan.unreachable.iter().all(|part| part.lines == [1, 2]), "{plan:?}");
    }

    #[test]
    fn a_path_that_is_too_long_is_refused() {
        let error = plan(&points(&[[0.2, 0.6, 0.25], [1e9, 0.0, 0.0]]), &example(), 1e-4).unwrap_err();
        assert_eq!(error.to_string(), "line 2: the path is too long for a machine of this size");
        let far = plan(&points(&[[0.2, 0.6, 0.25], [1e99, 0.0, 0.0]]), &example(), 1e-4);
        assert!(far.is_err());
    }

    #[test]
    fn a_path_that_comes_and_goes_without_end_is_refused() {
        // To and fro over the end of what the arms reach.
        let places = [[0.25, 0.784, 0.25], [0.25, 0.787, 0.25]].repeat(super::PARTS_MAX + 2);
        let error = plan(&points(&places), &example(), 1e-3).err().unwrap().to_string();
        assert!(error.ends_with(": more than 10000 parts of the path are unreachable"), "{error}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// Between two targets the arms move in proportion: wherever they are, the platform is near the path.
        #[test]
        fn motions_keep_to_the_path(
            a in [0.15..0.35_f64, 0.35..0.6, 0.15..0.35],
            b in [0.15..0.35_f64, 0.35..0.6, 0.15..0.35],
            tolerance in 1e-5..1e-3_f64,
        ) {
            let plan = planned(&[a, b], tolerance);
            prop_assert_eq!(plan.unreachable.len(), 0);
            for pair in plan.targets.windows(2) {
                prop_assert!(off(pair[1].at, a, b) < 1e-9);
                for step in 0..=10_u8 {
                    let part = f32::from(step) / 10.0;
                    let (from, to) = (pair[0].displacements, pair[1].displacements);
                    let arms = std::array::from_fn(|arm| from[arm] + (to[arm] - from[arm]) * part);
                    let at = example().pose(arms).unwrap().map(f64::from);
                    // What is between the three places that were looked at can be a little worse.
                    prop_assert!(off(at, pair[0].at, pair[1].at) <= tolerance * 1.2 + 1e-6);
                }
            }
        }
    }
}
