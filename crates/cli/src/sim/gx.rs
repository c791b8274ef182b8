//! The motion side of GX: six axes that move along vectors.

use std::time::Duration;

use deltarobot_protocols::gx::motion::{EventKind, Motion, Settings};
use deltarobot_protocols::gx::{AXES, ENCODED_MAX, Fault, POSITION_MAX, Vector};

use super::{Machine, above_zero, milliseconds};

/// Options of the axes.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Options of --protocol gx")]
pub(super) struct AxesOptions {
    /// Steps per second along the vector as long as no command has set any; 1000 by default
    #[arg(long, value_name = "STEPS", value_parser = above_zero)]
    velocity: Option<f64>,
    /// How far each axis can go to both sides, before the machine stops and says so; else as far as positions can be
    /// reported
    #[arg(long, value_name = "STEPS", value_parser = clap::value_parser!(i32).range(1..=i64::from(POSITION_MAX)))]
    travel: Option<i32>,
    /// How many axes there are, the first of x, y, z, a, b, c: commands for others are refused; 6 by default
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u8).range(1..=6))]
    axes: Option<u8>,
    /// Refuses moves until a session begins, with a numbered request for reports (`#1R0`), and then those without the
    /// next number; else numbers are the host's until it begins a session, with two such requests (`#1R0`, `#5462R0`)
    #[arg(long)]
    only_in_order: bool,
}

impl AxesOptions {
    /// The first of them that was given.
    pub(super) fn given(&self) -> Option<&'static str> {
        let given = [
            ("--velocity", self.velocity.is_some()),
            ("--travel", self.travel.is_some()),
            ("--axes", self.axes.is_some()),
            ("--only-in-order", self.only_in_order),
        ];
        given.into_iter().find_map(|(option, is_given)| is_given.then_some(option))
    }
}

/// Moves that the machine queues.
const QUEUE: usize = 16;

pub(super) struct Axes {
    motion: Motion<QUEUE>,
    machine: Moving,
    is_held: bool,
}

impl Axes {
    pub(super) fn new(options: &AxesOptions) -> Self {
        let settings = Settings {
            axes: (1 << options.axes.unwrap_or(6)) - 1,
            only_in_order: options.only_in_order.into(),
            ..Settings::default()
        };
        let mut axes = Self { motion: Motion::new(), machine: Moving::new(options), is_held: false };
        axes.motion.set(settings);
        axes.motion.set_position(&axes.machine.position());
        axes
    }

    /// Reports all that there is to report.
    fn report(&mut self, now: Duration, out: &mut Vec<u8>) {
        let now = milliseconds(now);
        // What else happened, the moves themselves show.
        while let Some(event) = self.motion.poll(now) {
            match event.kind {
                EventKind::Hold => self.is_held = true,
                EventKind::Resume => self.is_held = false,
                EventKind::Stop => {
                    self.machine.halt();
                    self.is_held = false;
                    self.motion.set_position(&self.machine.position());
                    self.motion.stop(Fault::Stopped as u8);
                }
                _ => (),
            }
        }
        let mut room = [0; ENCODED_MAX];
        loop {
            match self.motion.output(&mut room, now) {
                0 => break,
                length => out.extend_from_slice(room.get(..length).unwrap_or_default()),
            }
        }
    }

    /// Moves on, through as many moves as the time suffices for.
    fn advance(&mut self, mut seconds: f64) {
        while !self.is_held {
            if !self.machine.is_moving() {
                let Some((target, _)) = self.motion.next() else { break };
                self.machine.begin(target);
            }
            match self.machine.turn(seconds) {
                Turned::OnItsWay => break,
                Turned::Arrived { left } => {
                    self.motion.done();
                    seconds = left;
                }
                Turned::Stopped => {
                    self.motion.stop(Fault::Stopped as u8);
                    break;
                }
            }
        }
        // In range, as the machine sees to.
        self.motion.set_position(&self.machine.position());
    }
}

impl Machine for Axes {
    fn receive(&mut self, bytes: &[u8], now: Duration, out: &mut Vec<u8>) {
        let mut rest = bytes;
        while !rest.is_empty() {
            let taken = self.motion.receive(rest, milliseconds(now));
            rest = rest.get(taken..).unwrap_or_default();
            self.report(now, out);
        }
    }

    fn turn(&mut self, now: Duration, out: &mut Vec<u8>) {
        let passed = now.saturating_sub(self.machine.turned);
        self.machine.turned = now;
        self.advance(passed.as_secs_f64());
        self.report(now, out);
    }
}

/// What became of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turned {
    OnItsWay,
    /// It has ended, with so many seconds left.
    Arrived {
        left: f64,
    },
    /// An axis is at the end of its travel.
    Stopped,
}

/// The axes themselves.
#[derive(Clone, Debug)]
struct Moving {
    at: [f64; AXES],
    from: [f64; AXES],
    to: [f64; AXES],
    /// Steps per second.
    velocity: f64,
    /// Seconds since the move began, and that it takes; none: it stands.
    done: f64,
    takes: Option<f64>,
    travel: f64,
    turned: Duration,
}

impl Moving {
    fn new(options: &AxesOptions) -> Self {
        Self {
            at: [0.0; AXES],
            from: [0.0; AXES],
            to: [0.0; AXES],
            velocity: options.velocity.unwrap_or(1000.0),
            done: 0.0,
            takes: None,
            travel: options.travel.map_or(f64::INFINITY, f64::from),
            turned: Duration::ZERO,
        }
    }

    const fn is_moving(&self) -> bool {
        self.takes.is_some()
    }

    fn begin(&mut self, target: &Vector) {
        // Nothing moves at 0 steps per second: but slowly.
        self.velocity = target.velocity().map_or(self.velocity, |velocity| velocity.max(1).into());
        self.from = self.at;
        for (axis, to) in self.to.iter_mut().enumerate() {
            *to = target.axis(axis).map_or(*to, f64::from);
        }
        let way = self.to.iter().zip(self.from).map(|(to, from)| (to - from).powi(2)).sum::<f64>().sqrt();
        (self.done, self.takes) = (0.0, Some(way / self.velocity));
    }

    /// Stands where it is.
    fn halt(&mut self) {
        self.takes = None;
        self.to = self.at;
    }

    fn turn(&mut self, seconds: f64) -> Turned {
        let Some(takes) = self.takes else { return Turned::Arrived { left: seconds } };
        self.done += seconds;
        let part = if self.done >= takes { 1.0 } else { self.done / takes };
        for ((at, from), to) in self.at.iter_mut().zip(self.from).zip(self.to) {
            *at = from + (to - from) * part;
        }
        if self.at.iter().any(|at| at.abs() > self.travel) {
            for at in &mut self.at {
                *at = at.clamp(-self.travel, self.travel);
            }
            self.to = self.at;
            self.takes = None;
            return Turned::Stopped;
        }
        if self.done < takes {
            return Turned::OnItsWay;
        }
        self.takes = None;
        Turned::Arrived { left: self.done - takes }
    }

    /// In whole steps.
    #[expect(clippy::cast_possible_truncation, reason = "between positions, which are much smaller")]
    fn position(&self) -> [i32; AXES] {
        self.at.map(|at| at.round() as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::{Axes, AxesOptions, Duration, Machine};

    fn options() -> AxesOptions {
        AxesOptions { velocity: None, travel: None, axes: None, only_in_order: false }
    }

    /// What is answered to these bytes, at once and in the time that follows.
    fn answers(axes: &mut Axes, bytes: &[u8], milliseconds: u64) -> Vec<u8> {
        let mut out = Vec::new();
        let began = axes.machine.turned;
        axes.receive(bytes, began, &mut out);
        for tick in (5..=milliseconds).step_by(5) {
            axes.turn(began + Duration::from_millis(tick), &mut out);
        }
        out
    }

    #[test]
    fn moves_take_their_time() {
        let mut axes = Axes::new(&AxesOptions { only_in_order: true, ..options() });
        assert_eq!(answers(&mut axes, b"#2x1\nx1\n", 10), b"#2?17\n\n?18\n");
        assert_eq!(answers(&mut axes, b"#1R0\n", 0), b"#1\n");
        assert_eq!(answers(&mut axes, b"#2V1000x30y40\n#3x0\n", 45), b"");
        assert_eq!(axes.machine.position(), [27, 36, 0, 0, 0, 0]);
        assert_eq!(answers(&mut axes, b"", 10), b"&10626\n");
        assert_eq!(axes.machine.position(), [25, 40, 0, 0, 0, 0]);
        assert_eq!(answers(&mut axes, b"", 30), b"&8835\n");
        assert_eq!(axes.machine.position(), [0, 40, 0, 0, 0, 0]);
    }

    #[test]
    fn holds_goes_on_and_stops() {
        let mut axes = Axes::new(&options());
        assert_eq!(answers(&mut axes, b"#7V1000x100\n#8x0\n", 20), b"");
        assert_eq!(answers(&mut axes, b"%254\n", 500), b"%270\n");
        assert_eq!(axes.machine.position(), [20, 0, 0, 0, 0, 0]);
        assert_eq!(answers(&mut axes, b"%381\n", 30), b"%14\n");
        assert_eq!(axes.machine.position(), [50, 0, 0, 0, 0, 0]);
        assert_eq!(answers(&mut axes, b"%508\n", 100), b"#7?20\n=V1000x50y0z0a0b0c0\n");
        assert_eq!(axes.machine.position(), [50, 0, 0, 0, 0, 0]);
        assert_eq!(answers(&mut axes, b"%127\n%3\n", 0), b"\n?1\n%16\n");
        assert_eq!(answers(&mut axes, b"#9x40\n", 100), b"#9\n");
    }

    #[test]
    fn reports_and_errors() {
        let mut axes = Axes::new(&AxesOptions { travel: Some(100), ..options() });
        assert_eq!(answers(&mut axes, b"R10\n", 20), b"=x0y0z0a0b0c0\n".repeat(3));
        answers(&mut axes, b"R0\n", 0);
        assert_eq!(answers(&mut axes, b"#9 q\nx5x6\n", 0), b"#9?1\n\n?6\n");
        assert_eq!(answers(&mut axes, b"#\x85\x80*\x81\x81", 10), b"#\x85\x80");
        assert_eq!(answers(&mut axes, b"#7x-200\n#8x0\n", 300), b"#7?20\n");
        assert_eq!(axes.machine.position(), [-100, 0, 0, 0, 0, 0]);
        assert_eq!(answers(&mut axes, b"#9x0\n", 200), b"#9\n");

        let mut axes = Axes::new(&AxesOptions { axes: Some(2), ..options() });
        assert_eq!(answers(&mut axes, b"z1\nR1\nR0\n", 5), b"\n?19\n=x0y0\n");
    }
}
