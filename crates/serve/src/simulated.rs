//! Robots that are simulated in this program, at devices as others have.

use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use deltarobot_cli::far_end::{FarEnd, Input, Place};
use deltarobot_cli::sim::deltarobot::{Controller, ControllerOptions};
use deltarobot_cli::sim::random::Random;
use deltarobot_cli::sim::{Machine, TICK};
use deltarobot_cli::status::Failure;

/// Bytes that are read at a time.
const PIECE: usize = 256;

/// Begins with so many robots, for as long as the program lasts. Returns their devices.
pub(crate) fn start(count: usize) -> Result<Vec<PathBuf>, Failure> {
    let mut machines = Vec::new();
    for _ in 0..count {
        let controller = Controller::new(&ControllerOptions::default(), Random::new(None));
        machines.push((Place::default().make(None)?, controller));
    }
    let paths = machines.iter().map(|(far_end, _)| far_end.path().to_owned()).collect();
    thread::Builder::new()
        .name("simulated".into())
        .spawn(move || run(machines))
        .map_err(|error| Failure::of_file("thread", &error))?;
    Ok(paths)
}

/// All in one thread: each takes a microsecond or two.
fn run(mut machines: Vec<(Box<dyn FarEnd>, Controller)>) {
    let (clock, mut room) = (std::time::Instant::now(), [0; PIECE]);
    loop {
        thread::sleep(TICK);
        for (far_end, machine) in &mut machines {
            let (now, mut out) = (clock.elapsed(), Vec::new());
            // What can't be read or written is lost, as on any line.
            if let Ok(Input::Bytes(count @ 1..)) = far_end.read(&mut room, Duration::ZERO) {
                machine.receive(room.get(..count).unwrap_or_default(), now, &mut out);
            }
            machine.turn(now, &mut out);
            if !out.is_empty() {
                let _ = far_end.write(&out);
            }
        }
    }
}
