//! What serving takes: `make load`. The program owns many robots at pseudo-terminals that all move and report, each with
//! many watchers; measured are the times from a report's byte to its WebSocket, and from a cancel request to the byte on
//! the line, losses, and what the program takes.

#![allow(
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a measurement that can't go on fails"
)]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::os::fd::OwnedFd;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Barrier, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use deltarobot_cli::far_end::{FarEnd, Input, Place};
use deltarobot_protocols::deltarobot::{Layout, Message, Opcode, PAYLOAD_MAX, Position, Report, encode};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

const REPORTS_A_SECOND: u32 = 20;
const MOVING: u8 = 2;

/// How much there is of everything; the environment may say otherwise.
struct Load {
    robots: usize,
    watchers: usize,
    /// Watchers that never read.
    stalled: usize,
    seconds: usize,
    cancels: usize,
}

/// A robot that counts its reports by where it says it is.
struct Robot {
    line: Mutex<Box<dyn FarEnd>>,
    /// The same, to be polled.
    polled: OwnedFd,
    is_moving: AtomicBool,
    count: AtomicU64,
    /// When each report was sent, in nanoseconds since the beginning.
    sent: Vec<AtomicU64>,
    /// When it was cancelled first since this was 0: it may be asked again, to be sure that the answer is not an old
    /// one.
    cancelled: AtomicU64,
}

fn main() {
    let number = |name: &str, default| std::env::var(name).map_or(default, |value| value.parse().expect("a number"));
    let load = Load {
        robots: number("ROBOTS", 100),
        watchers: number("WATCHERS", 10),
        stalled: number("STALLED", 10),
        seconds: number("SECONDS", 30),
        cancels: number("CANCELS", 200),
    };
    rustix::process::setrlimit(rustix::process::Resource::Nofile, {
        let limit = rustix::process::getrlimit(rustix::process::Resource::Nofile);
        rustix::process::Rlimit { current: limit.maximum, ..limit }
    })
    .unwrap();
    let program =
        std::env::args().nth(1).filter(|argument| !argument.starts_with('-')).expect("the program to measure");
    println!(
        "| robots | watchers on each | watchers that never read | reports sent | events received, each lost | latency median | 99 % | highest | CPU | memory | cancel median | 99 % |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    load.run(&program, 0);
    load.run(&program, load.stalled);
}

impl Load {
    fn run(&self, program: &str, stalled: usize) {
        let reports = 2 * (self.seconds + 60) * REPORTS_A_SECOND as usize;
        let robots: Arc<Vec<_>> = Arc::new((0..=self.robots).map(|_| Robot::new(reports)).collect());
        let began = Instant::now();
        let is_over = Arc::new(AtomicBool::new(false));
        let threads = [
            spawn(&robots, &is_over, move |robots, over| report(robots, over, began)),
            spawn(&robots, &is_over, move |robots, over| answer(robots, over, began)),
        ];
        let (mut child, address) = start(program, &robots);
        for number in 0..robots.len() {
            drive(address, number);
        }
        let started = Arc::new(Barrier::new(self.robots * self.watchers + 1));
        let watchers: Vec<_> = (0..self.robots * self.watchers)
            .map(|number| {
                let (robots, started, is_over) = (Arc::clone(&robots), Arc::clone(&started), Arc::clone(&is_over));
                let robot = number % self.robots;
                thread::Builder::new()
                    .stack_size(256 << 10)
                    .spawn(move || watch(address, robot, &robots[robot], &started, &is_over, began))
                    .unwrap()
            })
            .collect();
        let _stalled: Vec<_> = (0..stalled).map(|number| connect(address, number % self.robots)).collect();
        started.wait();
        let (cpu, from, first) = (cpu_time(&child), Instant::now(), total(&robots));
        let cancels = self.cancel(address, &robots, began);
        thread::sleep(Duration::from_secs(self.seconds as u64).saturating_sub(from.elapsed()));
        let (cpu, time, sent) = (cpu_time(&child) - cpu, from.elapsed(), total(&robots) - first);
        let memory = memory(&child);
        is_over.store(true, Relaxed);
        let results: Vec<_> = watchers.into_iter().map(|watcher| watcher.join().unwrap()).collect();
        let (received, lost) =
            results.iter().fold((0, 0), |(received, lost), (times, missed)| (received + times.len(), lost + missed));
        let times = sorted(results.into_iter().flat_map(|(times, _)| times).collect());
        println!(
            "| {} | {} | {stalled} | {sent} | {received}, {lost} | {} ms | {} ms | {} ms | {:.2} cores | {memory} MB | {} ms | {} ms |",
            self.robots,
            self.watchers,
            at(&times, 0.5),
            at(&times, 0.99),
            at(&times, 1.0),
            cpu / time.as_secs_f64(),
            at(&cancels, 0.5),
            at(&cancels, 0.99),
        );
        child.kill().unwrap();
        child.wait().unwrap();
        for thread in threads {
            thread.join().unwrap();
        }
    }

    /// Cancels the last robot again and again. Returns how long that took, in microseconds.
    fn cancel(&self, address: SocketAddr, robots: &[Robot], began: Instant) -> Vec<u32> {
        let (robot, mut times) = (robots.last().unwrap(), Vec::new());
        for _ in 0..self.cancels {
            robot.cancelled.store(0, Relaxed);
            let before = nanoseconds(began);
            ask(address, &format!("POST /api/robots/r{}/cancel", robots.len() - 1), "", "");
            times.push(((robot.cancelled.load(Relaxed) - before) / 1000) as u32);
            drive(address, robots.len() - 1);
            thread::sleep(Duration::from_secs(self.seconds as u64) / (2 * self.cancels as u32));
        }
        sorted(times)
    }
}

impl Robot {
    fn new(reports: usize) -> Self {
        let sent = (0..reports).map(|_| AtomicU64::new(0)).collect();
        let line = Place::default().make(None).unwrap();
        let polled = line.as_fd().try_clone_to_owned().unwrap();
        let (is_moving, count, cancelled) = (false.into(), 0.into(), 0.into());
        Self { line: line.into(), polled, is_moving, count, sent, cancelled }
    }

    fn say(&self, message: &Message) {
        let (mut payload, mut frame) = ([0; PAYLOAD_MAX], [0; 64]);
        let length = message.write(Layout::Firmware, &mut payload);
        let length = encode(message.opcode(), &payload[..length], &mut frame).unwrap();
        self.line.lock().unwrap().write(&frame[..length]).unwrap();
    }

    fn report(&self, count: u64, began: Instant) {
        let position = Position([(count as f32).to_bits(), 0, 0]);
        let stat = if self.is_moving.load(Relaxed) { MOVING } else { 0 };
        self.sent[count as usize].store(nanoseconds(began), Relaxed);
        self.say(&Message::StatusReport(Report::new(position, stat)));
    }
}

fn spawn(
    robots: &Arc<Vec<Robot>>,
    is_over: &Arc<AtomicBool>,
    run: impl FnOnce(&[Robot], &AtomicBool) + Send + 'static,
) -> thread::JoinHandle<()> {
    let (robots, is_over) = (Arc::clone(robots), Arc::clone(is_over));
    thread::spawn(move || run(&robots, &is_over))
}

/// Has all robots report in turn, those that move.
fn report(robots: &[Robot], is_over: &AtomicBool, began: Instant) {
    let pause = Duration::from_secs(1) / REPORTS_A_SECOND / robots.len() as u32;
    let mut due = began;
    for robot in robots.iter().cycle() {
        due += pause;
        thread::sleep(due.saturating_duration_since(Instant::now()));
        if is_over.load(Relaxed) {
            return;
        }
        if robot.is_moving.load(Relaxed) {
            robot.report(robot.count.fetch_add(1, Relaxed) + 1, began);
        }
    }
}

/// Answers requests.
fn answer(robots: &[Robot], is_over: &AtomicBool, began: Instant) {
    let mut room = [0; 256];
    while !is_over.load(Relaxed) {
        let mut polled: Vec<_> = robots.iter().map(|robot| PollFd::new(&robot.polled, PollFlags::IN)).collect();
        let time = Timespec { tv_sec: 0, tv_nsec: 10_000_000 };
        if poll(&mut polled, Some(&time)).is_err() {
            continue;
        }
        let ready: Vec<_> = polled.iter().map(|polled| polled.revents().contains(PollFlags::IN)).collect();
        for (robot, _) in robots.iter().zip(ready).filter(|(_, is_ready)| *is_ready) {
            let now = nanoseconds(began);
            let came = robot.line.lock().unwrap().read(&mut room, Duration::ZERO).unwrap();
            let Input::Bytes(count) = came else { continue };
            // Requests come whole, and no target looks like one.
            for request in room[..count].windows(2).filter(|window| window[0] == b'$') {
                let opcode = Opcode(request[1]);
                match opcode {
                    Opcode::CANCEL => {
                        let _ = robot.cancelled.compare_exchange(0, now, Relaxed, Relaxed);
                        robot.is_moving.store(false, Relaxed);
                    }
                    Opcode::MOVE => robot.is_moving.store(true, Relaxed),
                    _ => (),
                }
                if opcode != Opcode::STATUS {
                    robot.say(&Message::Ack(opcode));
                }
                let position = Position([(robot.count.load(Relaxed) as f32).to_bits(), 0, 0]);
                let stat = if robot.is_moving.load(Relaxed) { MOVING } else { 0 };
                robot.say(&Message::StatusReport(Report::new(position, stat)));
            }
        }
    }
}

fn start(program: &str, robots: &[Robot]) -> (Child, SocketAddr) {
    let named = robots
        .iter()
        .enumerate()
        .map(|(number, robot)| format!("r{number}={}", robot.line.lock().unwrap().path().display()));
    let mut child = Command::new(program)
        .args(["--listen", "127.0.0.1:0", "--keep-moving"])
        .args(named)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    (child, line.trim().strip_prefix("http://").expect("an address").parse().unwrap())
}

/// Asks, and returns the answer's body.
fn ask(address: SocketAddr, what: &str, headers: &str, body: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_nodelay(true).unwrap();
    let length = body.len();
    let head = format!(
        "{what} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Type: application/json\r\n{headers}Content-Length: {length}\r\n\r\n{body}"
    );
    stream.write_all(head.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

/// Has a robot move on and on.
fn drive(address: SocketAddr, number: usize) {
    let began = Instant::now();
    loop {
        let answer = ask(address, &format!("POST /api/robots/r{number}/lease"), "", r#"{"force":true}"#);
        let word = answer.split("\"lease\":\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap_or_default();
        let headers = format!("Deltarobot-Lease: {word}\r\n");
        let answer =
            ask(address, &format!("POST /api/robots/r{number}/move"), &headers, r#"{"displacements":[1e6,1e6,1e6]}"#);
        if answer.starts_with("HTTP/1.1 202") {
            return;
        }
        // It may not have been opened yet, or not have ended its last motion.
        assert!(began.elapsed() < Duration::from_secs(60), "{answer}");
        thread::sleep(Duration::from_millis(2));
    }
}

type Socket = tungstenite::WebSocket<TcpStream>;

fn connect(address: SocketAddr, robot: usize) -> Socket {
    let config = tungstenite::protocol::WebSocketConfig::default().read_buffer_size(4096);
    let url = format!("ws://{address}/api/robots/r{robot}/events");
    let stream = TcpStream::connect(address).unwrap();
    tungstenite::client::client_with_config(url, stream, Some(config)).unwrap().0
}

/// Watches a robot. Returns the times from its reports to their events, in microseconds, and how many were lost.
fn watch(
    address: SocketAddr,
    number: usize,
    robot: &Robot,
    started: &Barrier,
    is_over: &AtomicBool,
    began: Instant,
) -> (Vec<u32>, usize) {
    let mut socket = connect(address, number);
    started.wait();
    // What was sent while a thousand others connected is not measured.
    let from = nanoseconds(began);
    let (mut times, mut lost, mut newest) = (Vec::new(), 0, None);
    while !is_over.load(Relaxed) {
        let Ok(message) = socket.read() else { break };
        let now = nanoseconds(began);
        let Ok(text) = message.into_text() else { continue };
        let Some(at) = text.split("\"displacements\":[").nth(1).and_then(|rest| rest.split('.').next()) else {
            continue;
        };
        let count: u64 = at.parse().unwrap();
        match newest {
            Some(newest) if count <= newest => continue,
            Some(newest) => {
                lost += (count - newest - 1) as usize;
                let sent = robot.sent[count as usize].load(Relaxed);
                if sent >= from {
                    times.push(((now - sent) / 1000) as u32);
                }
            }
            None => (),
        }
        newest = Some(count);
    }
    (times, lost)
}

fn nanoseconds(began: Instant) -> u64 {
    began.elapsed().as_nanos() as u64
}

fn total(robots: &[Robot]) -> u64 {
    robots.iter().take(robots.len() - 1).map(|robot| robot.count.load(Relaxed)).sum()
}

fn sorted(mut times: Vec<u32>) -> Vec<u32> {
    times.sort_unstable();
    times
}

/// The time below which such a share of them is, in milliseconds.
fn at(times: &[u32], share: f64) -> String {
    let index = ((times.len() as f64 * share) as usize).min(times.len().saturating_sub(1));
    times.get(index).map_or_else(|| "-".into(), |time| format!("{:.1}", f64::from(*time) / 1000.0))
}

/// Seconds of processor time.
fn cpu_time(child: &Child) -> f64 {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
    let fields: Vec<_> = stat.rsplit(')').next().unwrap().split_ascii_whitespace().collect();
    let ticks: u64 = fields[11..13].iter().map(|field| field.parse::<u64>().unwrap()).sum();
    ticks as f64 / rustix::param::clock_ticks_per_second() as f64
}

/// Resident, in megabytes.
fn memory(child: &Child) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<u64>().unwrap() / 1024
}
