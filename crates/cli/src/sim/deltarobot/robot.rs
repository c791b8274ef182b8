//! The simulated robot: three arms with an end stop each, at displacement 0.

use deltarobot_protocols::deltarobot::{Position, Report, State};

/// Displacement between two steps of the encoders.
const ENCODER_STEP: f64 = 2.5;
/// How far beyond an end stop a target may lie.
const TOLERANCE: f64 = 0.126;
/// What the specification has for an unknown position: a NaN, which one it does not say.
const NAN: Position = Position([0x7FC0_0000; 3]);

/// A robot that was just switched on.
#[derive(Debug)]
pub(super) struct Robot {
    at: [f64; 3],
    from: [f64; 3],
    to: [f64; 3],
    /// How much of the movement is done, 0 to 1.
    done: f64,
    state: State,
    /// Whether it knows where it is.
    is_homed: bool,
    /// Units a second of the fastest arm.
    speed: f64,
    /// Whether a move beyond an end stop is an error. Shipped firmware stops there, and is idle.
    stops_are_errors: bool,
}

impl Robot {
    pub(super) fn new(speed: f64, stops_are_errors: bool) -> Self {
        let at = [15.0, 20.0, 25.0];
        Self { at, from: at, to: at, done: 1.0, state: State::Idle, is_homed: false, speed, stops_are_errors }
    }

    /// Begins to home. These return whether that is possible.
    pub(super) fn home(&mut self) -> bool {
        self.is_homed = false;
        self.begin(State::Homing, [0.0; 3])
    }

    pub(super) fn move_to(&mut self, target: Position) -> bool {
        // Towards what is infinite there is no line.
        let finite = |bits| f64::from(f32::from_bits(bits).clamp(f32::MIN, f32::MAX));
        self.begin(State::Moving, target.0.map(finite))
    }

    pub(super) fn cancel(&mut self) -> bool {
        self.state = State::Idle;
        true
    }

    fn begin(&mut self, state: State, to: [f64; 3]) -> bool {
        (self.from, self.to, self.done, self.state) = (self.at, to, 0.0, state);
        true
    }

    /// Lets time pass. Returns whether an encoder made a step of a move.
    pub(super) fn turn(&mut self, seconds: f64) -> bool {
        let before = self.at;
        match self.state {
            State::Homing => {
                for arm in &mut self.at {
                    *arm = (*arm - self.speed * seconds).max(0.0);
                }
                if self.at.iter().all(|arm| *arm <= 0.0) {
                    self.is_homed = true;
                    self.state = State::Idle;
                }
                false
            }
            State::Moving => {
                self.advance(seconds);
                let step = |arm: f64| (arm / ENCODER_STEP).floor();
                self.at.iter().zip(before).any(|(now, before)| (step(*now) - step(before)).abs() >= 1.0)
            }
            State::Idle | State::Error => false,
        }
    }

    /// In a line: all arms begin and end at the same time.
    fn advance(&mut self, seconds: f64) {
        let way = self.to.iter().zip(self.from).map(|(to, from)| (to - from).abs()).fold(0.0, f64::max);
        self.done = if way > 0.0 { (self.done + seconds * self.speed / way).min(1.0) } else { 1.0 };
        for ((at, from), to) in self.at.iter_mut().zip(self.from).zip(self.to) {
            *at = from + (to - from) * self.done;
        }
        if self.done >= 1.0 {
            self.at = self.to;
            self.state = State::Idle;
        }
        if self.at.iter().any(|arm| *arm < -TOLERANCE) {
            self.state = if self.stops_are_errors { State::Error } else { State::Idle };
        }
        for arm in &mut self.at {
            *arm = arm.max(0.0);
        }
    }

    /// What it reports; `as_shipped` says which kind of NaN stands for an unknown position.
    #[expect(clippy::cast_possible_truncation, reason = "that is what is reported")]
    pub(super) fn report(&self, as_shipped: bool) -> Report {
        let unknown = if as_shipped { Position::UNKNOWN } else { NAN };
        let position = if self.is_homed { Position(self.at.map(|arm| (arm as f32).to_bits())) } else { unknown };
        let stops = self.at.iter().zip([4, 8, 16]).filter(|(arm, _)| **arm <= 0.0).map(|(_, bit)| bit);
        Report::new(position, stops.fold(self.state as u8, |stat, bit| stat | bit))
    }
}

#[cfg(test)]
mod tests {
    use super::{Position, Robot, State};

    fn at(arms: [f32; 3]) -> Position {
        Position(arms.map(f32::to_bits))
    }

    /// Until it stands; returns how many encoder steps there were.
    fn settle(robot: &mut Robot) -> usize {
        (0..10_000).filter(|_| robot.turn(0.005)).count()
    }

    #[test]
    fn homes_moves_and_meets_its_end_stops() {
        let mut robot = Robot::new(50.0, true);
        assert_eq!(robot.report(true).position, Position::UNKNOWN);
        robot.home();
        robot.turn(0.1);
        assert_eq!((robot.report(true).state(), robot.report(true).stat()), (State::Homing, 1));
        settle(&mut robot);
        assert_eq!((robot.report(true).stat(), robot.report(true).position), (0b11100, at([0.0; 3])));
        robot.move_to(at([10.0, 0.0, 5.5]));
        assert_eq!(settle(&mut robot), 4 + 2);
        assert_eq!((robot.report(true).stat(), robot.report(true).position), (0b01000, at([10.0, 0.0, 5.5])));
        robot.move_to(at([20.0, -0.1, 5.5]));
        settle(&mut robot);
        assert_eq!((robot.report(true).stat(), robot.report(true).position), (0b01000, at([20.0, 0.0, 5.5])));
        robot.move_to(at([20.0, -1.0, 5.5]));
        settle(&mut robot);
        assert_eq!(robot.report(true).state(), State::Error);
        robot.move_to(at([f32::INFINITY, f32::NEG_INFINITY, 5.5]));
        settle(&mut robot);
        assert_eq!(robot.report(true).state(), State::Error);
        assert!(robot.report(true).position.is_finite());

        let mut robot = Robot::new(50.0, false);
        robot.home();
        settle(&mut robot);
        robot.move_to(at([20.0, -1.0, 5.5]));
        settle(&mut robot);
        assert_eq!((robot.report(true).stat(), robot.report(true).state()), (0b01000, State::Idle));
    }

    #[test]
    fn a_cancelled_move_ends_on_its_way() {
        let mut robot = Robot::new(10.0, false);
        robot.home();
        settle(&mut robot);
        robot.move_to(at([10.0, 10.0, 10.0]));
        robot.turn(0.5);
        robot.cancel();
        assert!(!robot.turn(1.0));
        assert_eq!((robot.report(true).state(), robot.report(true).position), (State::Idle, at([5.0; 3])));
    }
}
