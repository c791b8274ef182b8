//! What is on the board. Ids and names are those of the conversation on the page "Ozeki Line Protocol", and so are the
//! commands setpushinfo and setswitch and the event heaterinfo. settemp and button are our own.

use std::time::Duration;

use deltarobot_protocols::line::device::Fault;
use deltarobot_protocols::line::{Encoder, Message};

/// The id of what the link itself is set up by.
pub(super) const MANAGER: &[u8] = b"0uAAly";
const HEATER: &[u8] = b"M1F910";
const SWITCH: &[u8] = b"9o5qzg";
const BUTTON: &[u8] = b"3Mx14T";

/// A device as its welcome describes it.
pub(super) struct Device {
    pub(super) id: &'static [u8],
    kind: &'static [u8],
    name: Option<&'static [u8]>,
}

/// In the order of their places.
pub(super) const DEVICES: [Device; 4] = [
    Device { id: MANAGER, kind: b"OzekiIDManager", name: None },
    Device { id: HEATER, kind: b"OzekiTemperatureController", name: Some(b"HeaterExt1") },
    Device { id: SWITCH, kind: b"OzekiSwitchController", name: Some(b"FanExt1") },
    Device { id: BUTTON, kind: b"OzekiButtonController", name: Some(b"StopYmin") },
];

impl Device {
    pub(super) fn welcome(&self, place: u16, line: &mut Encoder) {
        line.text(b"id", self.id).text(b"type", self.kind).word(b"pos", place);
        if let Some(name) = self.name {
            line.text(b"name", name);
        }
        line.text(b"version", b"1.0.0");
    }
}

const SETPUSHINFO: &[u8] = b"setpushinfo";
const SETTEMP: &[u8] = b"settemp";
const SETSWITCH: &[u8] = b"setswitch";

/// Which device executes what.
const COMMANDS: [(&[u8], &[u8]); 3] = [(HEATER, SETPUSHINFO), (HEATER, SETTEMP), (SWITCH, SETSWITCH)];

/// The name of the command, if the device has it.
pub(super) fn command(id: &[u8], message: &Message) -> Option<&'static [u8]> {
    let (_, command) = COMMANDS.into_iter().find(|(device, name)| *device == id && message.command().is(name))?;
    Some(command)
}

/// The desired temperature of a heater that has none.
const NONE: f32 = -1000.0;
/// Degrees of the room, and of a heater that is on and stays so.
const ROOM: f32 = 20.0;
const HOTTEST: f32 = 250.0;
/// Seconds in which a temperature comes nearer to where it would end, by a factor of e.
const LAG: f32 = 2.0;
/// Milliseconds between two reports that can be asked for.
const INTERVALS: std::ops::RangeInclusive<u32> = 20..=3_600_000;
/// For how long the button is held.
const HELD: Duration = Duration::from_millis(200);

pub(super) struct Board {
    turned: Duration,
    temperature: f32,
    /// Below this it heats.
    desired: f32,
    /// How often the heater reports.
    interval: Option<Duration>,
    report_at: Duration,
    switch: u8,
    pwm: u8,
    press_every: Duration,
    press_at: Duration,
    release_at: Option<Duration>,
}

/// What a device reports without being asked.
pub(super) struct Event {
    pub(super) id: &'static [u8],
    pub(super) name: &'static [u8],
    said: Said,
}

enum Said {
    Heater { temperature: f32, desired: f32, is_heating: bool },
    Button { is_pressed: bool },
}

impl Event {
    pub(super) fn write(&self, line: &mut Encoder) {
        match self.said {
            Said::Heater { temperature, desired, is_heating } => {
                line.float(b"temp", temperature, 2).float(b"desiredtemp", desired, 2);
                line.word(b"state", is_heating.into());
            }
            Said::Button { is_pressed } => {
                line.word(b"pressed", is_pressed.into());
            }
        }
    }
}

impl Board {
    pub(super) const fn new(press_every: Duration) -> Self {
        Self {
            turned: Duration::ZERO,
            temperature: ROOM,
            desired: NONE,
            interval: None,
            report_at: Duration::ZERO,
            switch: 0,
            pwm: 254,
            press_every,
            press_at: press_every,
            release_at: None,
        }
    }

    /// Switched off and on: only the heater stays as warm as it was.
    pub(super) const fn reset(&mut self, now: Duration) {
        let temperature = self.temperature;
        *self = Self::new(self.press_every);
        self.temperature = temperature;
        self.turned = now;
        self.press_at = now.saturating_add(self.press_every);
    }

    /// Executes a command of this name, and adds what is to be answered.
    ///
    /// # Errors
    ///
    /// It is refused.
    pub(super) fn execute(&mut self, name: &[u8], command: &Message, answer: &mut Encoder) -> Result<(), Fault> {
        let int = |name| command.get(name).map(|value| value.int().ok().ok_or(Fault::Refused)).transpose();
        let flag = |value| match value {
            Some(0) => Ok(false),
            Some(1) => Ok(true),
            _ => Err(Fault::Refused),
        };
        if name == SETPUSHINFO {
            let state = flag(int(b"state")?)?;
            let interval = u32::try_from(int(b"interval")?.unwrap_or(1000)).map_err(|_| Fault::Refused)?;
            if !INTERVALS.contains(&interval) {
                return Err(Fault::Refused);
            }
            self.interval = state.then_some(Duration::from_millis(interval.into()));
            self.report_at = self.turned + Duration::from_millis(interval.into());
            answer.word(b"state", state.into()).int(b"interval", i64::from(interval));
        } else if name == SETTEMP {
            let desired = command.get(b"temp").and_then(|temp| temp.float().ok());
            self.desired = desired.filter(|desired| (NONE..=HOTTEST).contains(desired)).ok_or(Fault::Refused)?;
            answer.float(b"temp", self.desired, 2);
        } else {
            let state = flag(int(b"state")?)?;
            if let Some(pwm) = int(b"pwm")? {
                self.pwm = u8::try_from(pwm).map_err(|_| Fault::Refused)?;
            }
            self.switch = state.into();
            answer.word(b"state", self.switch.into()).word(b"pwm", self.pwm.into());
        }
        Ok(())
    }

    /// Lets time pass.
    pub(super) fn turn(&mut self, now: Duration) -> Vec<Event> {
        let mut events = Vec::new();
        let is_heating = self.temperature < self.desired;
        let target = if is_heating { HOTTEST } else { ROOM };
        let left = (-now.saturating_sub(self.turned).as_secs_f32() / LAG).exp();
        self.temperature = target + (self.temperature - target) * left;
        self.turned = now;
        if let Some(interval) = self.interval
            && now >= self.report_at
        {
            self.report_at = (self.report_at + interval).max(now);
            let said = Said::Heater { temperature: self.temperature, desired: self.desired, is_heating };
            events.push(Event { id: HEATER, name: b"heaterinfo", said });
        }
        let is_pressed = match self.release_at {
            None if now >= self.press_at => true,
            Some(release_at) if now >= release_at => false,
            _ => return events,
        };
        self.release_at = is_pressed.then(|| now + HELD.min(self.press_every / 2));
        if is_pressed {
            self.press_at = now + self.press_every;
        }
        events.push(Event { id: BUTTON, name: b"button", said: Said::Button { is_pressed } });
        events
    }
}

#[cfg(test)]
mod tests {
    use super::{BUTTON, Board, Duration, Encoder, Fault, HEATER, MANAGER, Message, SWITCH, command};

    fn at(seconds: f64) -> Duration {
        Duration::from_secs_f64(seconds)
    }

    fn execute(board: &mut Board, id: &[u8], line: &str) -> Result<String, Fault> {
        let mut room = [0; 128];
        let mut answer = Encoder::begin(&mut room, b"x");
        let message = Message::parse(line.as_bytes()).unwrap();
        let command = command(id, &message).ok_or(Fault::UnknownCommand)?;
        board.execute(command, &message, &mut answer)?;
        let length = answer.length();
        Ok(String::from_utf8(room[..length].to_vec()).unwrap())
    }

    #[test]
    fn commands() {
        let mut board = Board::new(at(10.0));
        for (id, command, answer) in [
            (SWITCH, "c=setswitch&state=1", Ok("c=x&state=1&pwm=254")),
            (SWITCH, "c=setswitch&state=0&pwm=7", Ok("c=x&state=0&pwm=7")),
            (SWITCH, "c=setswitch&state=2", Err(Fault::Refused)),
            (SWITCH, "c=setswitch", Err(Fault::Refused)),
            (SWITCH, "c=setswitch&state=1&pwm=256", Err(Fault::Refused)),
            (HEATER, "c=setswitch&state=1", Err(Fault::UnknownCommand)),
            (HEATER, "c=setpushinfo&interval=2000&state=1", Ok("c=x&state=1&interval=2000")),
            (HEATER, "c=setpushinfo&interval=1&state=1", Err(Fault::Refused)),
            (HEATER, "c=settemp", Err(Fault::Refused)),
            (HEATER, "c=settemp&temp=1e9", Err(Fault::Refused)),
            (HEATER, "c=settemp&temp=200", Ok("c=x&temp=200.00")),
            (BUTTON, "c=setpushinfo&interval=2000&state=1", Err(Fault::UnknownCommand)),
            (MANAGER, "c=settemp&temp=1", Err(Fault::UnknownCommand)),
        ] {
            assert_eq!(execute(&mut board, id, command).as_deref(), answer.as_ref().copied(), "{command}");
        }
    }

    #[test]
    fn heater_and_button_tell() {
        let mut board = Board::new(at(1.0));
        execute(&mut board, HEATER, "c=setpushinfo&interval=500&state=1").unwrap();
        execute(&mut board, HEATER, "c=settemp&temp=100").unwrap();
        let mut lines = Vec::new();
        for step in 1..=6000 {
            for event in board.turn(at(f64::from(step) * 0.01)) {
                let mut room = [0; 128];
                let mut line = Encoder::begin(&mut room, event.name);
                event.write(&mut line);
                let length = line.length();
                lines.push(String::from_utf8(room[..length].to_vec()).unwrap());
            }
        }
        let heater: Vec<_> = lines.iter().filter(|line| line.starts_with("c=heaterinfo&")).collect();
        assert_eq!(heater.len(), 120);
        assert_eq!(heater[0], "c=heaterinfo&temp=70.88&desiredtemp=100.00&state=1");
        // From then on it is switched on and off.
        for line in &heater[1..] {
            let warm = Message::parse(line.as_bytes()).unwrap().get(b"temp").unwrap().float().unwrap();
            assert!((99.0..101.0).contains(&warm), "{line}");
        }
        let button: Vec<_> = lines.iter().filter(|line| line.starts_with("c=button&")).collect();
        assert!(button.len() >= 100, "{}", button.len());
        for (place, line) in button.iter().enumerate() {
            assert_eq!(**line, format!("c=button&pressed={}", 1 - place % 2));
        }
    }
}
