//! Both ends of the deltarobot format's link: any calls in any order at any time, whatever the line makes of what is
//! sent, whatever the firmware's functions do, and with anything in the structs. While a session is as it was made,
//! each request ends once and in time.
#![no_main]

use std::collections::BTreeMap;
use std::ffi::{c_int, c_ulong, c_void};
use std::ptr::{null, null_mut};

use deltarobot::controller::Controller;
use deltarobot::host::event::*;
use deltarobot::host::*;
use deltarobot::protocol::Position;
use deltarobot::sizes::DP_DATA_MAX_SIZE;
use deltarobot_fuzz::contract::{Standing, standing};
use deltarobot_fuzz::input::Input;
use deltarobot_fuzz::link::{self, Line, carry, fetch, give, in_range, later, run, written};
use deltarobot_fuzz::link_robot::{self, Robot, report_of};
use deltarobot_fuzz::object::{Object, Plain};
use libfuzzer_sys::fuzz_target;

/// How long all requests take to end when nothing is heard, with the default settings: first a cancel request, which
/// waits for its predecessor's answers and is sent four times, then so does the operation, then its doubts or its
/// silence.
const PATIENCE_MS: c_ulong = 2 * (500 + 250 + 4 * 250) + 3000;

fuzz_target!(|input: &[u8]| run::<Link>(input));

struct Link {
    host: Object<Host>,
    controller: Object<Controller>,
    /// Where the controller's pointers lie.
    pointers: std::ops::Range<usize>,
    robot: Box<Robot>,
    to_controller: Line,
    now: c_ulong,
    /// Opcodes of the requests that have not ended, and whether they were told to be accepted.
    open: BTreeMap<u8, bool>,
    /// Where the last move goes.
    target: [f32; 3],
    /// Whether the host's memory is as the library left it.
    sound: bool,
    /// Whether its settings are the default ones.
    plain: bool,
}

impl link::World for Link {
    fn new(input: &mut Input) -> Self {
        let controller = Object::default();
        let mut robot = Robot::new(controller.ptr(), input);
        unsafe {
            // Not made yet: all zero is refused.
            assert!(!link_robot::poll(&raw mut *robot, false));
            link_robot::make(&raw mut *robot, 0, 0, false);
        }
        Self {
            host: Object::default(),
            pointers: controller.places_of([robot.calls().cast(), (&raw const *robot).cast()]),
            controller,
            robot,
            to_controller: Line::new(),
            now: c_ulong::from_le_bytes(input.bytes::<8>()),
            open: BTreeMap::new(),
            target: [0.0; 3],
            sound: true,
            plain: true,
        }
    }

    fn step(&mut self, input: &mut Input) {
        let choice = input.byte();
        let variant = choice >> 5;
        match choice % 20 {
            0..3 => self.request(input, variant),
            3 | 4 => {
                let (bytes, _) = carry(&mut self.robot.sent, input, variant);
                self.host_receive(&bytes);
            }
            5 | 6 => {
                let (bytes, _) = carry(&mut self.to_controller, input, variant);
                unsafe { link_robot::receive(&raw mut *self.robot, &bytes) };
            }
            7 => self.host_receive(&input.line()),
            8 => unsafe { link_robot::receive(&raw mut *self.robot, &input.line()) },
            9 => self.host_poll(usize::from(variant)),
            10 => self.host_output(usize::from(input.byte())),
            11 => self.controller_poll(usize::from(variant), variant % 2 == 1),
            12 => self.wait(input, variant),
            13 => self.machine(input, variant),
            14 => self.host_init(input, variant),
            15 => self.scribble(input, variant),
            16 => self.nulls(),
            17 => self.robot.deeds.extend(input.bytes::<4>()),
            _ => self.exchange(variant),
        }
    }

    fn look(&self) {
        unsafe {
            in_range(dp_host_next_deadline(self.host.ptr(), self.now));
            let busy = dp_host_busy(self.host.ptr());
            assert!(if self.sound { busy == c_int::from(self.operates()) } else { busy | 1 == 1 });
            assert_eq!(dp_host_get_health(self.host.ptr(), &raw mut *Box::new(HostHealth::zero())), 0);
        }
    }

    fn everything_ends(&mut self) {
        if !self.sound || !self.plain {
            return;
        }
        let began = self.now;
        loop {
            self.host_poll(usize::MAX);
            self.host_output(DP_HOST_OUTPUT_MAX as usize);
            let deadline = unsafe { dp_host_next_deadline(self.host.ptr(), self.now) };
            if deadline < 0 {
                break;
            }
            assert!(deadline > 0, "nothing is left to do now");
            self.now = self.now.wrapping_add(deadline as c_ulong);
            assert!(self.now.wrapping_sub(began) <= PATIENCE_MS, "{:?} lasts too long", self.open);
        }
        assert!(self.open.is_empty(), "{:?} never ends", self.open);
    }
}

impl Link {
    /// As much as both ends have to say to each other now, over a good line, with a robot that is quick.
    fn exchange(&mut self, times: u8) {
        for _ in 0..times {
            self.host_poll(usize::MAX);
            self.host_output(DP_HOST_OUTPUT_MAX as usize);
            let bytes: Vec<_> = self.to_controller.drain(..).collect();
            unsafe { link_robot::receive(&raw mut *self.robot, &bytes) };
            self.controller_poll(8, false);
            let bytes: Vec<_> = self.robot.sent.drain(..).collect();
            self.host_receive(&bytes);
            self.robot.stands();
        }
    }

    fn request(&mut self, input: &mut Input, variant: u8) {
        let host = self.host.ptr();
        let (opcode, rc, fits) = match variant {
            0 | 1 => (b'H', unsafe { dp_host_home(host) }, true),
            2..5 => {
                let arms = Box::new([(); 3].map(|()| match variant {
                    4 => f32::from_le_bytes(input.bytes()),
                    _ => f32::from(input.byte() as i8),
                }));
                let [a, b, c] = *arms;
                let rc = unsafe { dp_host_move(host, &raw const *Box::new(Position { DA: a, DB: b, DC: c })) };
                if rc == 0 {
                    self.target = *arms;
                }
                (b'M', rc, arms.iter().all(|arm| arm.is_finite()))
            }
            5 => (b'C', unsafe { dp_host_cancel(host) }, true),
            _ => (b'S', unsafe { dp_host_status(host) }, true),
        };
        assert!(if fits { rc == 0 || rc == 5 } else { rc == 1 }, "{rc}");
        if !self.sound || !fits {
            return;
        }
        let busy = if b"HM".contains(&opcode) { self.operates() } else { self.open.contains_key(&opcode) };
        assert_eq!(rc == 5, busy);
        if !busy {
            self.open.insert(opcode, false);
        }
    }

    fn operates(&self) -> bool {
        self.open.contains_key(&b'H') || self.open.contains_key(&b'M')
    }

    /// Gives bytes to the host, and fetches events until it has taken them.
    fn host_receive(&mut self, bytes: &[u8]) {
        let receive = |link: &Self, bytes, count| unsafe { dp_host_receive(link.host.ptr(), bytes, count, link.now) };
        let all = give(self, bytes, receive, |link| link.host_poll(usize::MAX));
        assert!(all || !self.sound, "the host takes no bytes");
    }

    fn host_poll(&mut self, times: usize) {
        // All of them for each of the shortest frames that the ring has room for.
        let most = 256;
        let poll = |link: &Self, event: *mut HostEvent| unsafe { dp_host_poll(link.host.ptr(), link.now, event) };
        assert!(fetch(self, times, most, poll, Self::happened), "there is no end of events");
    }

    fn happened(&mut self, event: &HostEvent) {
        let HostEvent { kind, opcode, outcome, state, ref report, ref msg } = *event;
        assert!((0..=6).contains(&kind) && (0..=5).contains(&outcome) && (outcome != 0) == (kind == 6), "{event:?}");
        match kind {
            1 => {
                assert!((0..=DP_DATA_MAX_SIZE as c_int).contains(&msg.data_s) && msg.checksum_ok == 1, "{event:?}");
                assert!(b"ANHMSChsme".contains(&msg.opcode), "{event:?}");
            }
            2 | 3 if state == -1 => assert!(!self.sound, "{event:?}"),
            2 | 3 => assert!(report.STAT < 0x20 && state == c_int::from(report.STAT & 3), "{event:?}"),
            5 => assert!(b"HM".contains(&opcode), "{event:?}"),
            6 => assert!(b"HMCS".contains(&opcode), "{event:?}"),
            _ => (),
        }
        assert!(matches!(kind, 2 | 3) || state == -1);
        if !self.sound {
            return;
        }
        match kind {
            1 => assert!(!self.plain),
            5 => assert_eq!(self.open.insert(opcode, true), Some(false), "accepted once"),
            6 => {
                let accepted = self.open.remove(&opcode).expect("ended once");
                if b"HM".contains(&opcode) {
                    assert!(accepted || outcome != 1, "finished, but not accepted");
                    assert!(!accepted || outcome != 2, "refused, but accepted");
                } else {
                    assert!(matches!(outcome, 1 | 2 | 5), "{event:?}");
                }
            }
            _ => (),
        }
    }

    fn host_output(&mut self, cap: usize) {
        let frames = written(cap, true, |room, cap| unsafe { dp_host_output(self.host.ptr(), room, cap, self.now) });
        assert!(frames.len() <= DP_HOST_OUTPUT_MAX as usize);
        let mut rest = &frames[..];
        while !rest.is_empty() {
            let Standing::Intact(opcode, payload) = standing(rest) else { panic!("{frames:?}") };
            rest = &rest[payload.len() + 5..];
            match opcode {
                b'M' if self.sound => assert_eq!(payload, self.target.map(f32::to_le_bytes).concat()),
                b'M' => assert_eq!(payload.len(), 12),
                _ => assert!(payload.is_empty() && b"HCS".contains(&opcode)),
            }
            // The status is asked for during operations too, and a cancel request may be over before it leaves.
            assert!(!self.sound || opcode == b'S' || self.open.contains_key(&opcode));
        }
        self.to_controller.extend(frames);
    }

    fn controller_poll(&mut self, times: usize, idle: bool) {
        for _ in 0..times {
            if !unsafe { link_robot::poll(&raw mut *self.robot, idle) } {
                return;
            }
        }
    }

    fn wait(&mut self, input: &mut Input, variant: u8) {
        let deadline = unsafe { dp_host_next_deadline(self.host.ptr(), self.now) };
        self.now = later(self.now, deadline, input, variant);
    }

    /// What happens to the arms.
    fn machine(&mut self, input: &mut Input, variant: u8) {
        match variant {
            0..3 => self.robot.stands(),
            3 => self.robot.report = report_of([f32::NAN; 3], self.robot.report.STAT),
            4 => {
                let arms = [(); 3].map(|()| f32::from_le_bytes(input.bytes()));
                self.robot.report = report_of(arms, self.robot.report.STAT);
            }
            5 => self.robot.report.STAT = input.byte(),
            6 => unsafe { link_robot::report(&raw mut *self.robot) },
            _ => unsafe { link_robot::make(&raw mut *self.robot, input.int(), input.int(), input.byte() == 7) },
        }
    }

    fn host_init(&mut self, input: &mut Input, variant: u8) {
        let mut time = || c_ulong::from_le_bytes(input.bytes()) >> (variant * 8);
        let [ack_ms, guard_ms, settle_ms, poll_ms, silence_ms, operation_ms, gap_ms] = [(); 7].map(|()| time());
        let settings = HostSettings {
            ack_ms,
            guard_ms,
            settle_ms,
            poll_ms,
            silence_ms,
            operation_ms,
            gap_ms,
            tolerance: f32::from_le_bytes(input.bytes()),
            attempts: input.int(),
            layout: input.int(),
            messages: c_int::from(input.byte() % 2),
            duplicates: c_int::from(input.byte() % 2),
        };
        self.plain = variant == 0;
        let settings = if self.plain { null() } else { &raw const settings };
        assert_eq!(unsafe { dp_host_init(self.host.ptr(), settings) }, 0);
        self.open.clear();
        self.sound = true;
    }

    /// Goes beyond what is promised, but for the controller's pointers: no memory but the object's is touched even
    /// then, and what is told is in range.
    fn scribble(&mut self, input: &mut Input, variant: u8) {
        match variant {
            0..3 => {
                self.host.scribble(input, 0..0);
                self.sound = false;
            }
            3..6 => {
                self.controller.scribble(input, self.pointers.clone());
            }
            _ => self.host_init(&mut Input(&[]), 0),
        }
    }

    fn nulls(&self) {
        let (host, now) = (self.host.ptr(), self.now);
        let byte = (&raw const self.now).cast::<c_void>();
        unsafe {
            assert_eq!(dp_host_init(null_mut(), null()), 1);
            assert_eq!(dp_host_home(null_mut()), 1);
            assert_eq!(dp_host_move(host, null()), 1);
            assert_eq!(dp_host_cancel(null_mut()), 1);
            assert_eq!(dp_host_status(null_mut()), 1);
            assert_eq!(dp_host_receive(host, null(), 1, now), -1);
            assert_eq!(dp_host_receive(host, byte, -1, now), -1);
            assert_eq!(dp_host_output(host, null_mut(), 1, now), -1);
            assert_eq!(dp_host_poll(host, now, null_mut()), 1);
            assert_eq!(dp_host_next_deadline(null(), now), -1);
            assert_eq!(dp_host_busy(null()), 0);
            assert_eq!(dp_host_get_health(host, null_mut()), 1);
            link_robot::nulls(&raw const *self.robot);
        }
    }
}
