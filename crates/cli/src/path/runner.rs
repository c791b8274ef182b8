//! Hands out the targets of a path one after the other, and compares what is reached. Whoever moves the robot asks for the
//! [`Step`], makes the move, and says where the arms came to stand; in between, it can be paused.

use std::time::Duration;

use serde::Serialize;

use super::vector::distance;
use super::{Machine, Plan, Target};

/// A path that is being run.
#[derive(Clone, Debug)]
pub struct Runner {
    machine: Machine,
    targets: Vec<Target>,
    /// How far the arms have to go until each target, from the first on.
    ways: Vec<f64>,
    reached: Vec<Option<[f64; 3]>>,
    is_paused: bool,
    sum: f64,
    max: f64,
    known: u32,
}

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Move there.
    Move(Target),
    /// Nothing, until it goes on.
    Paused,
    /// Nothing more.
    Finished,
}

/// How far it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Progress {
    /// Targets that were reached.
    pub done: usize,
    /// All targets.
    pub all: usize,
    /// How much of the arms' way is done, 0 to 1, which says more about the time it takes.
    pub part: f64,
}

impl Progress {
    /// How long the rest takes, when what is done took so long without pauses; `None` at the beginning.
    #[must_use]
    pub fn time_left(&self, elapsed: Duration) -> Option<Duration> {
        Duration::try_from_secs_f64(elapsed.as_secs_f64() * (1.0 - self.part) / self.part).ok()
    }
}

/// Distances between the targets and where the platform came to stand, in the unit of the geometry.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Their mean.
    pub mean: f64,
    /// The largest one.
    pub max: f64,
}

impl Runner {
    /// A run of a plan from its beginning. `None` if there is nothing to do, or parts are unreachable.
    #[must_use]
    pub fn new(plan: &Plan, machine: &Machine) -> Option<Self> {
        if !plan.unreachable.is_empty() || plan.targets.is_empty() {
            return None;
        }
        let targets = plan.targets.clone();
        let mut way = 0.0;
        let next = targets.iter().skip(1);
        let ways = targets.iter().zip(next).map(|(from, to)| {
            // All arms take as long as the one that goes farthest.
            let arms = from.displacements.iter().zip(to.displacements);
            way += arms.map(|(from, to)| f64::from((to - from).abs())).fold(0.0, f64::max);
            way
        });
        let ways = std::iter::once(0.0).chain(ways).collect();
        Some(Self {
            machine: machine.clone(),
            targets,
            ways,
            reached: Vec::new(),
            is_paused: false,
            sum: 0.0,
            max: 0.0,
            known: 0,
        })
    }

    /// What to do next: the same until [`reached`](Self::reached) is called.
    #[must_use]
    pub fn step(&self) -> Step {
        match self.targets.get(self.reached.len()) {
            None => Step::Finished,
            Some(_) if self.is_paused => Step::Paused,
            Some(target) => Step::Move(*target),
        }
    }

    /// The move to the target has ended, with the arms at these displacements. Returns how far the platform is off;
    /// `None` if no pose has them, and after the last target.
    pub fn reached(&mut self, displacements: [f32; 3]) -> Option<f64> {
        let target = self.targets.get(self.reached.len())?;
        let at = self.machine.pose(displacements).map(|at| at.map(f64::from));
        let error = at.map(|at| distance(at, target.at));
        self.reached.push(at);
        if let Some(error) = error {
            self.sum += error;
            self.max = self.max.max(error);
            self.known += 1;
        }
        error
    }

    /// Makes no more moves until [`resume`](Self::resume). One that was begun can still be reached.
    pub fn pause(&mut self) {
        self.is_paused = true;
    }

    /// Goes on after a pause.
    pub fn resume(&mut self) {
        self.is_paused = false;
    }

    /// How far it is.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let (done, all) = (self.reached.len(), self.targets.len());
        let way = |count: usize| count.checked_sub(1).and_then(|place| self.ways.get(place)).copied().unwrap_or(0.0);
        let part = if done == all { 1.0 } else { way(done) / way(all).max(f64::MIN_POSITIVE) };
        Progress { done, all, part }
    }

    /// How far it was off; `None` until a target was reached.
    #[must_use]
    pub fn errors(&self) -> Option<Errors> {
        (self.known > 0).then(|| Errors { mean: self.sum / f64::from(self.known), max: self.max })
    }

    /// The targets.
    #[must_use]
    pub fn targets(&self) -> &[Target] {
        &self.targets
    }

    /// Where the platform came to stand at each of them, as far as it is; `None` where no pose has such displacements.
    #[must_use]
    pub fn reached_points(&self) -> &[Option<[f64; 3]>] {
        &self.reached
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::machine::tests::example;
    use super::super::{Waypoint, plan};
    use super::{Runner, Step};

    fn runner() -> Runner {
        let points = [([0.2, 0.4, 0.2], false), ([0.3, 0.4, 0.2], true), ([0.3, 0.4, 0.3], true)];
        let points = points.map(|(at, is_drawing)| Waypoint { at, is_drawing, line: 1 });
        Runner::new(&plan(&points, &example(), 1.0).unwrap(), &example()).unwrap()
    }

    #[test]
    fn targets_follow_each_other() {
        let mut runner = runner();
        assert_eq!((runner.progress().done, runner.progress().all, runner.errors()), (0, 3, None));
        assert_eq!(runner.progress().time_left(Duration::from_secs(1)), None);
        let targets = runner.targets().to_vec();
        let mut part = 0.0;
        for (number, target) in (1..).zip(targets) {
            assert_eq!(runner.step(), Step::Move(target));
            let [a, b, c] = target.displacements;
            // A unit is a millimetre.
            let error = runner.reached([a + if number == 2 { 1.0 } else { 0.0 }, b, c]).unwrap();
            assert!(if number == 2 { (1e-4..1e-2).contains(&error) } else { error < 1e-6 }, "{error}");
            assert!(number == 1 || runner.progress().part > part);
            part = runner.progress().part;
        }
        assert_eq!((runner.step(), runner.reached([0.0; 3]), part), (Step::Finished, None, 1.0));
        let errors = runner.errors().unwrap();
        assert!((errors.mean - errors.max / 3.0).abs() < 1e-6, "{errors:?}");
        assert_eq!(runner.progress().time_left(Duration::from_secs(9)), Some(Duration::ZERO));
    }

    #[test]
    fn a_pause_is_between_two_targets() {
        let mut runner = runner();
        let Step::Move(target) = runner.step() else { panic!() };
        runner.pause();
        assert_eq!(runner.step(), Step::Paused);
        runner.reached(target.displacements);
        assert_eq!((runner.step(), runner.progress().done), (Step::Paused, 1));
        runner.resume();
        assert_eq!(runner.step(), Step::Move(runner.targets()[1]));
        // What is no pose counts as reached, but has no error.
        assert_eq!(runner.reached([f32::NAN; 3]), None);
        assert_eq!((runner.progress().done, runner.reached_points()[1]), (2, None));
        assert!(runner.errors().unwrap().max < 1e-6);
    }

    #[test]
    fn what_can_not_be_reached_is_not_begun() {
        let points = [Waypoint { at: [9.0; 3], is_drawing: false, line: 1 }];
        let plan = plan(&points, &example(), 1.0).unwrap();
        assert!(Runner::new(&plan, &example()).is_none());
        assert!(Runner::new(&super::Plan::default(), &example()).is_none());
    }
}
