//! What a broker takes from `deltarobot serve`: `make load`. Programs own many simulated robots that all move and report;
//! one subscriber counts what the broker passes on, and misses nothing, as the states of each robot are numbered.

#![allow(
    clippy::arithmetic_side_effects,
    clippy::cast_precision_loss,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a measurement that can't go on fails"
)]

use std::collections::HashMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::{Packet, PublishProperties};
use rumqttc::v5::{Client, Event, MqttOptions};

/// What has not come by then won't come.
const TIMEOUT: Duration = Duration::from_secs(300);

struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn main() {
    let number = |name: &str, default| std::env::var(name).map_or(default, |value| value.parse().expect("a number"));
    let (programs, robots, seconds) = (number("PROGRAMS", 5), number("ROBOTS", 100), number("SECONDS", 60));
    let program = std::env::args().skip(1).find(|argument| !argument.starts_with("--"));
    let program = program.unwrap_or_else(|| env!("CARGO_BIN_EXE_deltarobot-serve").into());
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("broker-load");
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).unwrap();
    let Some((broker, port)) = broker(&directory) else {
        assert!(std::env::var("DP_REQUIRE_TOOLS").as_deref() != Ok("1"), "mosquitto is not installed");
        return eprintln!("passed over: mosquitto is not installed");
    };
    let mut options = MqttOptions::new("load", "127.0.0.1", port);
    options.set_receive_maximum(Some(1000)).set_max_packet_size(Some(1 << 16));
    let (client, mut connection) = Client::new(options, 10_000);
    client.subscribe("load/#", QoS::AtLeastOnce).unwrap();
    let servers: Vec<_> = (0..programs).map(|number| server(&program, &directory, port, number, robots)).collect();

    let mut seen = Seen::default();
    let began = Instant::now();
    let (mut asked, mut counting) = (HashMap::new(), None);
    for event in connection.iter() {
        if let Event::Incoming(Packet::Publish(publish)) = event.unwrap() {
            let topic = std::str::from_utf8(&publish.topic).unwrap();
            let Some(robot) = topic.strip_suffix("/state") else { continue };
            let text = std::str::from_utf8(&publish.payload).unwrap();
            seen.take(robot, text);
            // Each homes, then moves for some minutes.
            let step: &mut u8 = asked.entry(robot.to_owned()).or_default();
            let wanted = match *step {
                0 if text.contains("\"link\":\"up\"") && text.contains("\"state\":\"idle\"") => Some(("home", "")),
                1 if text.contains("\"position_known\":true") && text.contains("\"state\":\"idle\"") => {
                    Some(("move", "{\"displacements\":[1000000,1000000,1000000]}"))
                }
                _ => None,
            };
            if let Some((word, payload)) = wanted {
                *step += 1;
                let properties =
                    PublishProperties { message_expiry_interval: Some(600), ..PublishProperties::default() };
                let topic = format!("{robot}/command/{word}");
                client.try_publish_with_properties(topic, QoS::AtLeastOnce, false, payload, properties).unwrap();
            }
            if counting.is_none() && text.contains("\"state\":\"moving\"") {
                seen.moving.insert(robot.to_owned());
                if seen.moving.len() == programs * robots {
                    println!("{} robots move after {:.0} s", seen.moving.len(), began.elapsed().as_secs_f64());
                    counting = Some((
                        Instant::now(),
                        seen.states,
                        cpu(&broker.0),
                        servers.iter().map(|it| cpu(&it.0)).sum::<f64>(),
                    ));
                }
            }
        }
        if let Some((since, before, broker_before, servers_before)) = counting {
            let time = since.elapsed().as_secs_f64();
            if time >= seconds as f64 {
                let states = seen.states - before;
                let servers_now: f64 = servers.iter().map(|it| cpu(&it.0)).sum();
                println!(
                    "{states} states in {time:.1} s: {:.0} a second, {} lost, {} twice; processor: {:.2} for each program, {:.2} for the broker",
                    states as f64 / time,
                    seen.lost,
                    seen.again,
                    (servers_now - servers_before) / time / programs as f64,
                    (cpu(&broker.0) - broker_before) / time,
                );
                assert_eq!(seen.lost, 0, "states were lost");
                return;
            }
        }
        assert!(counting.is_some() || began.elapsed() < TIMEOUT, "{} robots move", seen.moving.len());
    }
}

/// What has come.
#[derive(Default)]
struct Seen {
    states: u64,
    lost: u64,
    again: u64,
    numbers: HashMap<String, u64>,
    moving: std::collections::HashSet<String>,
}

impl Seen {
    fn take(&mut self, robot: &str, text: &str) {
        let rest = &text[text.find("\"seq\":").unwrap() + 6..];
        let number: u64 = rest[..rest.find(',').unwrap()].parse().unwrap();
        self.states += 1;
        match self.numbers.get_mut(robot) {
            Some(last) => {
                if number > *last {
                    self.lost += number - *last - 1;
                } else {
                    self.again += 1;
                }
                *last = (*last).max(number);
            }
            None => drop(self.numbers.insert(robot.to_owned(), number)),
        }
    }
}

/// Seconds of the processor's time that a program has had.
fn cpu(child: &Child) -> f64 {
    let text = fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
    let fields: Vec<_> = text.rsplit(')').next().unwrap().split_whitespace().collect();
    // In hundredths of a second, as Linux tells programs.
    fields[11..13].iter().map(|ticks| ticks.parse::<f64>().unwrap()).sum::<f64>() / 100.0
}

fn broker(directory: &Path) -> Option<(Running, u16)> {
    let path = std::env::var("PATH").unwrap_or_default() + ":/usr/sbin:/usr/local/sbin";
    let program = std::env::split_paths(&path).map(|path| path.join("mosquitto")).find(|path| path.is_file())?;
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let settings = directory.join("mosquitto.conf");
    let text = "max_inflight_messages 1000\nmax_queued_messages 0\nallow_anonymous true\nset_tcp_nodelay true\n";
    fs::write(&settings, format!("listener {port} 127.0.0.1\n{text}")).unwrap();
    let child = Command::new(program).arg("-c").arg(settings).stderr(Stdio::null()).spawn().unwrap();
    let began = Instant::now();
    while TcpStream::connect(("127.0.0.1", port)).is_err() {
        assert!(began.elapsed() < TIMEOUT, "the broker listens");
        sleep(Duration::from_millis(50));
    }
    Some((Running(child), port))
}

fn server(program: &str, directory: &Path, port: u16, number: usize, robots: usize) -> Running {
    let settings: PathBuf = directory.join(format!("serve{number}.toml"));
    let mqtt = format!("[mqtt]\nurl = \"mqtt://127.0.0.1:{port}\"\nprefix = \"load/{number}\"\ncommands = true\n");
    fs::write(&settings, format!("simulated = {robots}\nlisten = \"127.0.0.1:0\"\n{mqtt}")).unwrap();
    let mut command = Command::new(program);
    let mut child = command.arg("--config").arg(&settings).stdout(Stdio::piped()).spawn().unwrap();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut String::new()).unwrap();
    Running(child)
}
