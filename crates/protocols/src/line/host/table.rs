//! The devices that have signed in: event `welcome`.

use zerocopy::FromBytes;

use super::Message;
use crate::line::Value;

/// Longest id of a device. The page has 6 characters.
pub const ID_MAX: usize = 15;
/// Longest type of a device.
pub const TYPE_MAX: usize = 47;
/// Longest name of a device.
pub const NAME_MAX: usize = 31;
/// Longest version of a device.
pub const VERSION_MAX: usize = 15;

/// A device. Its texts are decoded and end with a 0; those it did not give are empty.
#[derive(Clone, Debug, FromBytes)]
pub struct Device {
    /// What it is called in messages.
    pub id: [u8; ID_MAX + 1],
    /// What it is, e.g. `OzekiSwitchController`.
    pub r#type: [u8; TYPE_MAX + 1],
    /// What its user calls it.
    pub name: [u8; NAME_MAX + 1],
    /// Its version.
    pub version: [u8; VERSION_MAX + 1],
    /// Its place among the devices behind the microcontroller; 0 when it did not give one.
    pub pos: i32,
    /// Not 0: its type, name or version is longer than there is room, and was cut off.
    pub cut: u8,
}

/// The devices of a session, `DEVICES` at most.
#[derive(Clone, Debug, FromBytes)]
pub(super) struct Devices<const DEVICES: usize> {
    device: [Device; DEVICES],
    /// Not 0: has signed in since the microcontroller started last.
    signed_in: [u8; DEVICES],
    count: u8,
}

/// Whether and where a device that has signed in is listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listed {
    /// It is in the table.
    Whole(usize),
    /// It is in the table, but not all that it gave.
    Cut(usize),
    /// It is not in the table, which is full.
    Full,
    /// It is not in the table: its id is too long, or has a 0 in it.
    IdTooLong,
    /// It is not in the table: it has no id.
    NoId,
}

impl<const DEVICES: usize> Devices<DEVICES> {
    pub(super) fn all(&self) -> &[Device] {
        self.device.get(..self.count.into()).unwrap_or(&self.device)
    }

    /// A device signs in. Returns whether it did so before, without any other sign of a restart: then this is one.
    pub(super) fn welcome(&mut self, message: &Message<'_>) -> bool {
        let Ok(id) = id_of(message) else { return false };
        let known = self.find(id);
        let index = known.unwrap_or(self.all().len());
        let Some(device) = self.device.get_mut(index) else { return false };
        let mut cut = write(&mut device.id, id);
        cut |= write(&mut device.r#type, message.text(b"type"));
        cut |= write(&mut device.name, message.text(b"name"));
        cut |= write(&mut device.version, message.text(b"version"));
        device.cut = u8::from(cut);
        device.pos = message.get(b"pos").and_then(|pos| pos.int().ok()).unwrap_or_default();
        if known.is_none() {
            self.count = u8::try_from(index.wrapping_add(1)).unwrap_or_default();
        }
        let restarted = known.is_some() && self.signed_in.get(index).is_some_and(|signed_in| *signed_in != 0);
        for (place, signed_in) in self.signed_in.iter_mut().enumerate() {
            if place == index {
                *signed_in = 1;
            } else if restarted {
                *signed_in = 0;
            }
        }
        restarted
    }

    /// Whether and where the device is listed that has signed in by this line.
    pub(super) fn listed(&self, message: &Message<'_>) -> Listed {
        let id = match id_of(message) {
            Ok(id) => id,
            Err(unlisted) => return unlisted,
        };
        match self.find(id).and_then(|index| Some((index, self.device.get(index)?))) {
            Some((index, Device { cut: 0, .. })) => Listed::Whole(index),
            Some((index, _)) => Listed::Cut(index),
            None => Listed::Full,
        }
    }

    /// The place of the device of an id.
    fn find(&self, id: Value<'_>) -> Option<usize> {
        self.all().iter().position(|device| id.is(before_zero(&device.id)))
    }
}

/// The id of a device that signs in, or why it can't be listed.
fn id_of<'a>(message: &Message<'a>) -> Result<Value<'a>, Listed> {
    let id = message.text(b"id");
    if id.is_empty() {
        Err(Listed::NoId)
    } else if id.len() > ID_MAX || id.bytes().any(|byte| byte == 0) {
        Err(Listed::IdTooLong)
    } else {
        Ok(id)
    }
}

/// Writes a text and zeros behind it. Whether that is not all of it: for want of room, or as there is a zero in it.
fn write(out: &mut [u8], value: Value<'_>) -> bool {
    let mut text = value.bytes();
    let mut cut = false;
    if let Some((end, room)) = out.split_last_mut() {
        for place in room {
            let byte = if cut { None } else { text.next() };
            cut |= byte == Some(0);
            *place = byte.unwrap_or_default();
        }
        *end = 0;
    }
    cut || text.next().is_some()
}

/// A text up to its first zero.
fn before_zero(text: &[u8]) -> &[u8] {
    text.split(|byte| *byte == 0).next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::{Device, Listed, Message, TYPE_MAX};
    use zerocopy::FromZeros;

    const DEVICES: usize = 16;
    type Devices = super::Devices<DEVICES>;

    fn welcome(devices: &mut Devices, line: &str) -> (Listed, bool) {
        let message = Message::parse(line.as_bytes()).unwrap();
        let restarted = devices.welcome(&message);
        (devices.listed(&message), restarted)
    }

    fn texts(device: &Device) -> [&str; 4] {
        [&device.id[..], &device.r#type, &device.name, &device.version].map(|bytes| {
            let (text, zeros) = bytes.split_at(bytes.iter().position(|byte| *byte == 0).unwrap());
            assert!(zeros.iter().all(|byte| *byte == 0));
            str::from_utf8(text).unwrap()
        })
    }

    #[test]
    fn are_listed() {
        let mut devices = Devices::new_zeroed();
        let line = "c=welcome&id=M1F910&type=OzekiTemperatureController&pos=6&name=Heater%20Ext1&version=1.0.0";
        assert_eq!(welcome(&mut devices, line), (Listed::Whole(0), false));
        let line = "c=welcome&type=Ozeki3DPrinterDisc&id=OZPDSC";
        assert_eq!(welcome(&mut devices, line), (Listed::Whole(1), false));
        let [heater, disc] = devices.all() else { panic!("there are two") };
        assert_eq!(texts(heater), ["M1F910", "OzekiTemperatureController", "Heater Ext1", "1.0.0"]);
        assert_eq!(texts(disc), ["OZPDSC", "Ozeki3DPrinterDisc", "", ""]);
        assert_eq!((heater.pos, heater.cut, disc.pos), (6, 0, 0));
    }

    #[test]
    fn a_restart_is_seen_once() {
        let mut devices = Devices::new_zeroed();
        for round in 0..3 {
            for (place, id) in ["a", "b", "c"].into_iter().enumerate() {
                let listed = (Listed::Whole(place), round > 0 && place == 0);
                assert_eq!(welcome(&mut devices, &format!("c=welcome&id={id}")), listed);
            }
        }
        // One whose line was lost.
        assert_eq!(welcome(&mut devices, "c=welcome&id=b"), (Listed::Whole(1), true));
        assert_eq!(welcome(&mut devices, "c=welcome&id=a"), (Listed::Whole(0), false));
        assert_eq!(welcome(&mut devices, "c=welcome&id=c"), (Listed::Whole(2), false));
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let mut devices = Devices::new_zeroed();
        let long = "x".repeat(TYPE_MAX + 1);
        assert_eq!(welcome(&mut devices, &format!("c=welcome&id=a&type={long}")), (Listed::Cut(0), false));
        assert_eq!(texts(&devices.all()[0])[1], &long[1..]);
        assert_eq!(devices.all()[0].cut, 1);
        assert_eq!(welcome(&mut devices, "c=welcome&id=b&name=x%00y"), (Listed::Cut(1), false));
        assert_eq!(texts(&devices.all()[1])[2], "x");
        assert_eq!(welcome(&mut devices, "c=welcome&id=0123456789abcdef"), (Listed::IdTooLong, false));
        assert_eq!(welcome(&mut devices, "c=welcome&id=x%00"), (Listed::IdTooLong, false));
        assert_eq!(welcome(&mut devices, "c=welcome&id="), (Listed::NoId, false));
        assert_eq!(welcome(&mut devices, "c=welcome"), (Listed::NoId, false));
        for place in 2..DEVICES {
            assert_eq!(welcome(&mut devices, &format!("c=welcome&id={place}")), (Listed::Whole(place), false));
        }
        assert_eq!(welcome(&mut devices, "c=welcome&id=z"), (Listed::Full, false));
        assert_eq!(devices.all().len(), DEVICES);
    }
}
