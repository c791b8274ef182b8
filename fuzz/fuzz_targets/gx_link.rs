//! Both ends of the GX protocol's link: any calls in any order at any time, whatever the line makes of what is sent,
//! and with anything in the structs. While a session is as it was made, each move ends once and in time; over a line
//! that forges nothing, as finished only if it was carried out.
#![no_main]

use std::ffi::{c_int, c_ulong, c_void};
use std::ptr::{null, null_mut};

use deltarobot::gx::{GX_ENCODED_MAX, Vector};
use deltarobot::gx_host::event::*;
use deltarobot::gx_host::{self, *};
use deltarobot::gx_motion::{self, *};
use deltarobot::sizes::{GX_QUEUE_MAX, GX_WINDOW_MAX};
use deltarobot_fuzz::input::Input;
use deltarobot_fuzz::link::{self, Line, carry, fetch, give, later, run, written};
use deltarobot_fuzz::object::{Object, Plain};
use libfuzzer_sys::fuzz_target;

const POSITIONS: std::ops::RangeInclusive<i32> = -(1 << 27)..=(1 << 27) - 1;

fuzz_target!(|input: &[u8]| run::<Link>(input));

struct Link {
    host: Object<Host>,
    motion: Object<Motion>,
    to_motion: Line,
    to_host: Line,
    now: c_ulong,
    path: [i32; 6],
    /// Moves whose ends were not told.
    unfinished: usize,
    finished: usize,
    done: usize,
    /// Moves that the firmware has fetched.
    fetched: usize,
    /// Whether the memory of both is as the library left it.
    sound: [bool; 2],
    /// Whether the host gives up in the end.
    gives_up: bool,
    /// Whether nothing came that the other end has not sent, and no session was forgotten unseen.
    honest: bool,
}

impl link::World for Link {
    fn new(input: &mut Input) -> Self {
        Self {
            host: Object::default(),
            motion: Object::default(),
            to_motion: Line::new(),
            to_host: Line::new(),
            now: c_ulong::from_le_bytes(input.bytes::<8>()),
            path: [0; 6],
            unfinished: 0,
            finished: 0,
            done: 0,
            fetched: 0,
            sound: [true; 2],
            gives_up: true,
            honest: true,
        }
    }

    fn step(&mut self, input: &mut Input) {
        let choice = input.byte();
        let variant = choice >> 5;
        match choice % 24 {
            0..3 => self.request(input, variant),
            3 => self.report(input, variant),
            4 | 5 => {
                let (bytes, as_sent) = carry(&mut self.to_host, input, variant);
                self.honest &= as_sent;
                self.host_receive(&bytes);
            }
            6 | 7 => {
                let (bytes, as_sent) = carry(&mut self.to_motion, input, variant);
                self.honest &= as_sent;
                self.motion_receive(&bytes);
            }
            8 => {
                let bytes = self.raw(input, variant);
                self.host_receive(&bytes);
            }
            9 => {
                let bytes = self.raw(input, variant);
                self.motion_receive(&bytes);
            }
            10 => self.host_poll(usize::from(variant)),
            11 => self.host_output(usize::from(input.byte())),
            12 => self.motion_poll(usize::from(variant)),
            13 => self.motion_output(usize::from(input.byte())),
            14 => self.wait(input, variant),
            15 | 16 => self.machine(input, variant),
            17 => self.host_init(input, variant),
            18 => self.motion_init(input, variant),
            19 => self.scribble(input, variant),
            20 => self.nulls(),
            21 => {
                let control = if variant < 4 { variant.into() } else { input.int() };
                let rc = unsafe { gx_host_control(self.host.ptr(), control) };
                assert_eq!(rc, c_int::from(!(0..4).contains(&control)));
            }
            _ => self.exchange(),
        }
    }

    fn look(&self) {
        unsafe {
            link::in_range(gx_host_next_deadline(self.host.ptr(), self.now));
            link::in_range(gx_motion_next_deadline(self.motion.ptr(), self.now));
            let unfinished = gx_host_unfinished(self.host.ptr());
            assert!(if self.sound[0] { unfinished == self.unfinished as c_int } else { unfinished >= 0 });
            let queued = gx_motion_unfinished(self.motion.ptr());
            assert!(queued >= 0);
            assert!(!self.sound[1] || (self.fetched..=GX_QUEUE_MAX).contains(&(queued as usize)));
            assert_eq!(gx_host_get_health(self.host.ptr(), &raw mut *Box::new(gx_host::HostHealth::zero())), 0);
            assert_eq!(gx_motion_get_health(self.motion.ptr(), &raw mut *Box::new(gx_motion::MotionHealth::zero())), 0);
        }
    }

    fn everything_ends(&mut self) {
        if !self.sound[0] || !self.gives_up {
            return;
        }
        for _ in 0..64 + 16 * GX_WINDOW_MAX {
            self.host_poll(usize::MAX);
            self.host_output(GX_ENCODED_MAX as usize * (GX_WINDOW_MAX + 4));
            if self.unfinished == 0 {
                return;
            }
            let deadline = unsafe { gx_host_next_deadline(self.host.ptr(), self.now) };
            self.now = self.now.wrapping_add(c_ulong::try_from(deadline).expect("there is a deadline"));
        }
        panic!("{} moves never end", self.unfinished);
    }
}

impl Link {
    /// As much as both ends have to say to each other now, over a good line, with a machine that is quick.
    fn exchange(&mut self) {
        for _ in 0..3 {
            self.host_poll(usize::MAX);
            self.host_output(1024);
            let bytes: Vec<_> = self.to_motion.drain(..).collect();
            self.motion_receive(&bytes);
            self.motion_poll(usize::MAX);
            while self.next_move() {
                self.finish();
            }
            self.motion_output(1024);
            let bytes: Vec<_> = self.to_host.drain(..).collect();
            self.host_receive(&bytes);
        }
        self.host_poll(usize::MAX);
    }

    fn request(&mut self, input: &mut Input, variant: u8) {
        let how = input.byte();
        for axis in 0..6 {
            if how >> axis & 1 == 1 {
                self.path[axis] = match variant {
                    0 => i32::from_le_bytes(input.bytes()),
                    1 => i32::from_le_bytes(input.bytes()) >> 5,
                    _ => self.path[axis].wrapping_add(i32::from(input.byte() as i8)),
                };
            }
        }
        let axes = if variant == 7 { input.int() } else { c_int::from(how & 0x3F) };
        let velocity = if how & 0xC0 == 0 { -1 } else { input.int() };
        let flagged = |axis: &usize| axes >> axis & 1 == 1;
        let fits = (0..0x40).contains(&axes)
            && (0..6).filter(flagged).all(|axis| POSITIONS.contains(&self.path[axis]))
            && ((0..1 << 14).contains(&velocity) || velocity == -1 && axes != 0);
        let target = Box::new(self.path);
        let rc = unsafe { gx_host_move(self.host.ptr(), target.as_ptr(), axes, velocity) };
        assert!(if fits { rc == 0 || rc == 5 } else { rc == 1 }, "{rc}");
        assert!(!self.sound[0] || (rc == 5) == (fits && self.unfinished == GX_WINDOW_MAX));
        self.unfinished += usize::from(rc == 0);
        // The motion side does that by itself.
        self.done += usize::from(rc == 0 && axes == 0);
        if !fits {
            self.path = [0; 6];
        }
    }

    fn report(&mut self, input: &mut Input, variant: u8) {
        let period = if variant == 0 { input.int() } else { c_int::from(input.byte() % 100) };
        let rc = unsafe { gx_host_report(self.host.ptr(), period) };
        assert_eq!(rc, c_int::from(!(0..1 << 14).contains(&period)));
    }

    fn host_receive(&mut self, bytes: &[u8]) {
        let receive = |link: &Self, bytes, count| unsafe { gx_host_receive(link.host.ptr(), bytes, count, link.now) };
        let all = give(self, bytes, receive, |link| link.host_poll(usize::MAX));
        assert!(all || !self.sound[0], "the host takes no bytes");
    }

    fn host_poll(&mut self, times: usize) {
        let poll = |link: &Self, event: *mut HostEvent| unsafe { gx_host_poll(link.host.ptr(), link.now, event) };
        let ended = fetch(self, times, 16 + GX_WINDOW_MAX, poll, Self::happened);
        assert!(ended || !self.sound[0], "there is no end of events");
    }

    fn happened(&mut self, event: &HostEvent) {
        assert!((0..=GX_HOST_UNANSWERED).contains(&event.kind) && (event.outcome != 0) == (event.kind == 1));
        assert!((0..=GX_HOST_DEVIATED).contains(&event.outcome) && (0..256).contains(&event.code));
        if self.sound[0] {
            assert!((-1..1 << 14).contains(&event.number) && event.code < 128);
        }
        match event.kind {
            1 if self.sound[0] => {
                self.unfinished = self.unfinished.checked_sub(1).expect("ended once");
                self.finished += usize::from(event.outcome == 1);
            }
            GX_HOST_REPORT | GX_HOST_DRIFT | GX_HOST_STOPPED if self.sound[0] => in_range(&event.position),
            _ => (),
        }
        if self.honest && self.sound == [true; 2] {
            assert!(self.finished <= self.done, "finished, but not carried out");
            assert_ne!(event.outcome, GX_HOST_DEVIATED);
        }
    }

    fn host_output(&mut self, cap: usize) {
        let bytes = written(cap, false, |room, cap| unsafe { gx_host_output(self.host.ptr(), room, cap, self.now) });
        self.to_motion.extend(bytes);
    }

    fn motion_receive(&mut self, bytes: &[u8]) {
        let receive =
            |link: &Self, bytes, count| unsafe { gx_motion_receive(link.motion.ptr(), bytes, count, link.now) };
        let all = give(self, bytes, receive, |link| {
            link.motion_poll(usize::MAX);
            link.motion_output(1024);
        });
        assert!(all || !self.sound[1], "the motion side takes no bytes");
    }

    fn motion_poll(&mut self, times: usize) {
        let poll = |link: &Self, event: *mut MotionEvent| unsafe { gx_motion_poll(link.motion.ptr(), link.now, event) };
        let ended = fetch(self, times, 8, poll, |link, event| {
            if link.sound[1] {
                let has_code = event.kind == GX_MOTION_REFUSED || event.kind == GX_MOTION_STOP;
                assert!((0..=GX_MOTION_STOP).contains(&event.kind) && (event.code != 0) == has_code, "{event:?}");
                assert!((-1..1 << 14).contains(&event.number) && (0..128).contains(&event.code), "{event:?}");
                assert!((0..1 << 14).contains(&event.period), "{event:?}");
            }
            if event.kind == GX_MOTION_STOP {
                assert_eq!(unsafe { gx_motion_stop(link.motion.ptr(), 0) }, 0);
                link.fetched = 0;
            }
        });
        assert!(ended || !self.sound[1], "there is no end of events");
    }

    fn motion_output(&mut self, cap: usize) {
        let bytes =
            written(cap, false, |room, cap| unsafe { gx_motion_output(self.motion.ptr(), room, cap, self.now) });
        self.to_host.extend(bytes);
    }

    fn machine(&mut self, input: &mut Input, variant: u8) {
        match variant {
            0..3 => drop(self.next_move()),
            3..6 => drop(self.finish()),
            6 => {
                let code = if input.byte() % 2 == 0 { 0 } else { input.int() };
                let rc = unsafe { gx_motion_stop(self.motion.ptr(), code) };
                assert_eq!(rc, c_int::from(code != 0 && !(64..128).contains(&code)));
                if rc == 0 {
                    self.fetched = 0;
                }
            }
            _ => {
                let shift = input.byte() % 16;
                let position = Box::new([(); 6].map(|()| i32::from_le_bytes(input.bytes()) >> shift));
                let rc = unsafe { gx_motion_set_position(self.motion.ptr(), position.as_ptr()) };
                assert_eq!(rc, c_int::from(!position.iter().all(|value| POSITIONS.contains(value))));
            }
        }
    }

    fn next_move(&mut self) -> bool {
        let (mut target, mut number) = (Box::new(Vector { mask: 0xFF, ..Vector::zero() }), -2);
        let rc = unsafe { gx_motion_next(self.motion.ptr(), &raw mut *target, &raw mut number) };
        assert!(rc == 0 || rc == 6);
        if rc == 0 {
            self.fetched += 1;
            assert!((-1..1 << 14).contains(&number) || !self.sound[1]);
            if self.sound[1] {
                in_range(&target);
                assert!(self.fetched <= GX_QUEUE_MAX);
            }
        }
        rc == 0 && self.fetched <= GX_QUEUE_MAX
    }

    fn finish(&mut self) {
        let rc = unsafe { gx_motion_done(self.motion.ptr()) };
        assert!(rc == 0 || rc == 6);
        if self.sound[1] {
            assert_eq!(rc == 0, self.fetched > 0);
        }
        if rc == 0 {
            self.fetched = self.fetched.saturating_sub(1);
            self.done += 1;
        }
    }

    fn wait(&mut self, input: &mut Input, variant: u8) {
        let deadline = unsafe {
            match input.byte() % 2 {
                0 => gx_host_next_deadline(self.host.ptr(), self.now),
                _ => gx_motion_next_deadline(self.motion.ptr(), self.now),
            }
        };
        self.now = later(self.now, deadline, input, variant);
    }

    fn host_init(&mut self, input: &mut Input, variant: u8) {
        let mut time = |shift: u8| c_ulong::from_le_bytes(input.bytes()) >> (shift * 8);
        let [answer_ms, probe_ms, move_ms, gap_ms] = [variant, 6, variant, 7].map(&mut time);
        let settings = gx_host::HostSettings {
            answer_ms,
            probe_ms,
            move_ms,
            gap_ms,
            attempts: input.int(),
            window: input.int(),
            ascii: c_int::from(input.byte() % 2),
            first_number: input.int(),
            absolute_every: input.int(),
            echo: c_int::from(input.byte() % 16 == 0),
        };
        let settings = if variant == 0 { null() } else { &raw const settings };
        assert_eq!(unsafe { gx_host_init(self.host.ptr(), settings) }, 0);
        self.gives_up = variant == 0;
        self.unfinished = 0;
        self.sound[0] = true;
        // What it expects to come may have been sent to the one before.
        self.honest = false;
    }

    fn motion_init(&mut self, input: &mut Input, variant: u8) {
        let settings = gx_motion::MotionSettings {
            gap_ms: c_ulong::from(input.byte()),
            axes: input.int(),
            only_in_order: c_int::from(input.byte() % 2),
            host_ms: if input.byte() % 2 == 0 { 0 } else { c_ulong::from(input.byte()) * 50 },
        };
        // Or else it takes what comes next as from any host.
        self.honest &= variant != 0 && settings.only_in_order != 0;
        let settings = if variant == 0 { null() } else { &raw const settings };
        assert_eq!(unsafe { gx_motion_init(self.motion.ptr(), settings) }, 0);
        self.fetched = 0;
        self.sound[1] = true;
    }

    /// Goes beyond what is promised: no memory but the object's is touched even then.
    fn scribble(&mut self, input: &mut Input, variant: u8) {
        match variant {
            0 | 1 => {
                self.host.scribble(input, 0..0);
                (self.sound[0], self.honest) = (false, false);
            }
            2 | 3 => {
                self.motion.scribble(input, 0..0);
                (self.sound[1], self.honest) = (false, false);
            }
            4 => self.motion_init(&mut Input(&[]), 0),
            _ => self.host_init(&mut Input(&[]), 0),
        }
    }

    fn raw(&mut self, input: &mut Input, variant: u8) -> Vec<u8> {
        self.honest = false;
        let count = usize::from(input.byte() % 64);
        let bytes = input.slice(count);
        let times = if variant == 7 { 10 } else { 1 };
        bytes.iter().copied().cycle().take(times * bytes.len()).collect()
    }

    fn nulls(&self) {
        let (host, motion, now) = (self.host.ptr(), self.motion.ptr(), self.now);
        let byte = (&raw const self.now).cast::<c_void>();
        unsafe {
            assert_eq!(gx_host_init(null_mut(), null()), 1);
            assert_eq!(gx_host_move(host, null(), 1, 1), 1);
            assert_eq!(gx_host_receive(host, null(), 1, now), -1);
            assert_eq!(gx_host_receive(host, byte, -1, now), -1);
            assert_eq!(gx_host_output(host, null_mut(), 1, now), -1);
            assert_eq!(gx_host_poll(host, now, null_mut()), 1);
            assert_eq!(gx_host_next_deadline(null(), now), -1);
            assert_eq!(gx_host_unfinished(null()), 0);
            assert_eq!(gx_motion_init(null_mut(), null()), 1);
            assert_eq!(gx_motion_receive(motion, null(), 1, now), -1);
            assert_eq!(gx_motion_output(motion, null_mut(), 1, now), -1);
            assert_eq!(gx_motion_poll(motion, now, null_mut()), 1);
            assert_eq!(gx_motion_next(motion, null_mut(), null_mut()), 1);
            assert_eq!(gx_motion_set_position(motion, null()), 1);
            assert_eq!(gx_motion_next_deadline(null(), now), -1);
            assert_eq!(gx_host_get_health(host, null_mut()), 1);
            assert_eq!(gx_motion_get_health(motion, null_mut()), 1);
        }
    }
}

fn in_range(vector: &Vector) {
    assert!(vector.mask < 0x80 && vector.velocity < 1 << 14, "{vector:?}");
    assert!((0..6).filter(|axis| vector.mask >> axis & 1 == 1).all(|axis| POSITIONS.contains(&vector.axes[axis])));
}
