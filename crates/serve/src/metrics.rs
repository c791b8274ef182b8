//! `/metrics`, in the text format of Prometheus.

use std::fmt::{Display, Write};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::fleet::Fleet;
use crate::outside::Outside;
use crate::state::{Doing, Link, State};

/// Text with metrics in it.
#[derive(Default)]
struct Page(String);

/// What a metric is, as scrapers know it.
const COUNTER: &str = "counter";
/// See above.
const GAUGE: &str = "gauge";

impl Page {
    fn head(&mut self, name: &str, kind: &str, help: &str) {
        // Nothing fails to be written into a String.
        let _ = writeln!(self.0, "# HELP deltarobot_{name} {help}\n# TYPE deltarobot_{name} {kind}");
    }

    fn one(&mut self, name: &str, kind: &str, help: &str, value: impl Display) {
        self.head(name, kind, help);
        let _ = writeln!(self.0, "deltarobot_{name} {value}");
    }

    /// One that each robot has, or may have.
    fn each<'a, T: Display>(
        &mut self,
        robots: impl IntoIterator<Item = (&'a str, Option<T>)>,
        name: &str,
        kind: &str,
        help: &str,
    ) {
        self.head(name, kind, help);
        for (robot, value) in robots {
            if let Some(value) = value {
                let _ = writeln!(self.0, "deltarobot_{name}{{robot=\"{}\"}} {value}", escaped(robot));
            }
        }
    }
}

/// The value of a label.
fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

/// A metric of each robot: its name, what it is, and where it is found.
type OfState<T> = (&'static str, &'static str, fn(&State) -> T);

/// All there is.
pub(crate) fn page(fleet: &Fleet, outside: &Outside) -> String {
    let mut page = Page::default();
    let states: Vec<_> = fleet.robots.values().map(|robot| (robot, robot.snapshot())).collect();
    let health: [OfState<u64>; 8] = [
        ("frames_total", "Messages that were received.", |state| state.health.frames),
        ("malformed_total", "Messages whose content is none.", |state| state.health.malformed),
        ("strays_total", "Messages that were not expected.", |state| state.health.strays),
        ("garbage_bytes_total", "Bytes that are no message.", |state| state.health.garbage_bytes),
        ("checksum_failures_total", "Messages with a wrong checksum.", |state| state.health.checksum_failures),
        ("timeouts_total", "Answers that did not come in time.", |state| state.health.timeouts),
        ("retransmissions_total", "Requests that were sent again.", |state| state.health.retransmissions),
        ("reconnects_total", "Times that the port was lost.", |state| state.health.reconnects),
    ];
    for (name, help, of) in health {
        page.each(states.iter().map(|(robot, state)| (&**robot.name(), Some(of(state)))), name, COUNTER, help);
    }
    let seconds = |state: &State| state.health.round_trip_ms.map(|ms| f64::from(ms) / 1000.0);
    page.each(
        states.iter().map(|(robot, state)| (&**robot.name(), seconds(state))),
        "round_trip_seconds",
        GAUGE,
        "Mean time from a request to its answer.",
    );
    let gauges: [OfState<bool>; 3] = [
        ("link_up", "Whether the port is open.", |state| state.link == Link::Up),
        ("stale", "Whether the robot has not answered lately.", |state| state.stale),
        ("error", "Whether the robot reports an error.", |state| state.state == Doing::Error),
    ];
    for (name, help, of) in gauges {
        page.each(states.iter().map(|(robot, state)| (&**robot.name(), Some(u8::from(of(state))))), name, GAUGE, help);
    }
    page.each(
        states.iter().map(|(robot, _)| (&**robot.name(), Some(robot.events.receiver_count()))),
        "watchers",
        GAUGE,
        "Connections that watch this robot alone.",
    );
    page.one("watchers_of_all", GAUGE, "Connections that watch all robots.", of(&fleet.watchers));
    page.one("dropped_total", COUNTER, "Events that slow watchers have lost.", of(&fleet.dropped));
    if let Some(mqtt) = &outside.mqtt {
        let counts = &mqtt.counts;
        page.one("mqtt_up", GAUGE, "Whether the broker is connected.", u8::from(mqtt.is_online()));
        for (name, help, count) in [
            ("mqtt_connections_total", "Connections to the broker.", &counts.connections),
            ("mqtt_published_total", "Messages that were given to the broker.", &counts.published),
            ("mqtt_dropped_total", "Events that the broker took too slowly.", &counts.dropped),
            ("mqtt_commands_total", "Commands that were carried out.", &counts.commands),
            ("mqtt_refused_total", "Commands that were refused.", &counts.refused),
        ] {
            page.one(name, COUNTER, help, of(count));
        }
    }
    if let Some(records) = &outside.progress {
        page.one("record_bytes_total", COUNTER, "Bytes that were recorded.", of(&records.written));
        page.one("record_lost_total", COUNTER, "Messages that could not be recorded.", of(&records.lost));
        page.one("record_up", GAUGE, "Whether records can be written.", u8::from(records.error().is_none()));
    }
    page.0
}

fn of(count: &AtomicU64) -> u64 {
    count.load(Ordering::Relaxed)
}

#[cfg(test)]
mod tests {
    use super::{GAUGE, Page, escaped};

    #[test]
    fn names_end_no_label() {
        assert_eq!(escaped("a\"} 1\nb\\"), "a\\\"} 1\\nb\\\\");
        let mut page = Page::default();
        page.each([("a\"\nb", Some(1)), ("c", None)], "x", GAUGE, "Y.");
        assert_eq!(page.0, "# HELP deltarobot_x Y.\n# TYPE deltarobot_x gauge\ndeltarobot_x{robot=\"a\\\"\\nb\"} 1\n");
    }
}
