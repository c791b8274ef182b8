//! The firmware of a robot, whose functions do what the input says.

use std::collections::VecDeque;
use std::ffi::{c_int, c_void};
use std::ptr::{null, null_mut};

use deltarobot::controller::*;
use deltarobot::protocol::{Position, StatusReport};

use crate::contract::{Standing, standing};
use crate::input::Input;
use crate::link::{Line, give};
use crate::object::Plain;

const HOMING: u8 = 1;
const MOVING: u8 = 2;

pub struct Robot {
    controller: *mut Controller,
    calls: Calls,
    pub report: StatusReport,
    target: [f32; 3],
    pub sent: Line,
    /// What the functions do besides, one after the other.
    pub deeds: VecDeque<u8>,
    depth: u8,
    /// Whether the controller was made, and not unmade by a call of `dp_controller_init` that was refused.
    made: bool,
}

impl Robot {
    pub fn new(controller: *mut Controller, input: &mut Input) -> Box<Self> {
        let lacks = input.byte();
        Box::new(Self {
            controller,
            calls: Calls {
                home: (lacks & 0x81 != 0x81).then_some(home),
                r#move: (lacks & 0x82 != 0x82).then_some(start_move),
                cancel: (lacks & 0x84 != 0x84).then_some(cancel),
                read: Some(read),
                send: Some(send),
            },
            report: StatusReport::zero(),
            target: [0.0; 3],
            sent: Line::new(),
            deeds: VecDeque::new(),
            depth: 0,
            made: false,
        })
    }

    pub fn calls(&self) -> *const Calls {
        &raw const self.calls
    }

    pub fn stands(&mut self) {
        self.report = report_of(self.target, 0);
    }
}

pub fn report_of([a, b, c]: [f32; 3], stat: u8) -> StatusReport {
    StatusReport { DA: a, DB: b, DC: c, STAT: stat }
}

/// Makes the controller, or tries to: with layouts that there are not, and without functions.
///
/// # Safety
///
/// The robot is one, and so for the functions below.
pub unsafe fn make(robot: *mut Robot, layout: c_int, flags: c_int, without: bool) {
    unsafe {
        let calls = if without { null() } else { (*robot).calls() };
        let rc = dp_controller_init((*robot).controller, calls, robot.cast(), layout, flags);
        assert_eq!(rc, c_int::from(without || !(0..=2).contains(&layout)));
        if (0..=2).contains(&layout) {
            (*robot).made = !without;
        }
    }
}

/// Calls `dp_controller_poll`, or `dp_controller_poll_idle`; whether there may be more to do.
pub unsafe fn poll(robot: *mut Robot, idle: bool) -> bool {
    unsafe {
        let (controller, sent, made) = ((*robot).controller, (*robot).sent.len(), (*robot).made);
        let calm = (*robot).deeds.is_empty();
        let rc = if idle { dp_controller_poll_idle(controller) } else { dp_controller_poll(controller) };
        assert!(if made { rc == 0 || rc == 2 } else { rc == 1 }, "{rc}");
        assert!(!calm || (rc == 0) == ((*robot).sent.len() > sent), "all that is done is answered or told");
        rc == 0
    }
}

/// Calls `dp_controller_receive`, and the controller's functions until it has taken all bytes.
pub unsafe fn receive(robot: *mut Robot, bytes: &[u8]) {
    let controller = unsafe { (*robot).controller };
    let receive = |_: &_, bytes, count| unsafe { dp_controller_receive(controller, bytes, count) };
    let poll = |robot: &mut *mut Robot| while unsafe { poll(*robot, false) } {};
    let all = give(&mut { robot }, bytes, receive, poll);
    assert!(all || unsafe { !(*robot).made }, "the controller takes no bytes");
}

/// Calls `dp_controller_report`.
pub unsafe fn report(robot: *mut Robot) {
    unsafe {
        let made = (*robot).made;
        assert_eq!(dp_controller_report((*robot).controller), c_int::from(!made));
    }
}

/// What the functions may do, besides what they are for. Returns what they do that for badly.
unsafe fn do_more(robot: *mut Robot) -> u8 {
    unsafe {
        if (*robot).depth >= 4 {
            return 0;
        }
        let Some(deed) = (*robot).deeds.pop_front() else { return 0 };
        (*robot).depth += 1;
        match deed % 16 {
            0 => make(robot, c_int::from(deed >> 4 & 3), c_int::from(deed >> 5), false),
            1 => make(robot, 0, 0, true),
            2 => report(robot),
            3 | 4 => drop(poll(robot, deed & 0x10 != 0)),
            5 => receive(robot, b"$S\0\xB1:"),
            6 => receive(robot, b"$H\0\xA6:$C\0\xA1:$M\x0C"),
            _ => (),
        }
        (*robot).depth -= 1;
        deed
    }
}

/// Begins something, or refuses.
unsafe fn begin(robot: *mut Robot, stat: u8) -> c_int {
    unsafe {
        let deed = do_more(robot);
        if deed & 0x40 == 0 {
            (*robot).report.STAT = stat;
        }
        // Refused, or said to be, or neither.
        c_int::from(deed as i8 >> 7)
    }
}

unsafe extern "C" fn home(usr: *mut c_void) -> c_int {
    unsafe {
        let robot: *mut Robot = usr.cast();
        (*robot).target = [0.0; 3];
        begin(robot, HOMING)
    }
}

unsafe extern "C" fn start_move(target: *const Position, usr: *mut c_void) -> c_int {
    unsafe {
        let Position { DA, DB, DC } = *target;
        assert!([DA, DB, DC].iter().all(|arm| !arm.is_nan()));
        let robot: *mut Robot = usr.cast();
        (*robot).target = [DA, DB, DC];
        begin(robot, MOVING)
    }
}

unsafe extern "C" fn cancel(usr: *mut c_void) -> c_int {
    unsafe { begin(usr.cast(), 0) }
}

unsafe extern "C" fn read(report: *mut StatusReport, usr: *mut c_void) {
    let robot: *mut Robot = usr.cast();
    unsafe {
        let deed = do_more(robot);
        match deed >> 6 {
            // Forgets to.
            1 => (),
            2 => *report = report_of([f32::from_bits(u32::MAX); 3], deed),
            _ => *report = (*robot).report.copy(),
        }
    }
}

unsafe extern "C" fn send(frame: *mut c_void, bytes: c_int, usr: *mut c_void) -> c_int {
    let robot: *mut Robot = usr.cast();
    unsafe {
        let frame = std::slice::from_raw_parts_mut(frame.cast::<u8>(), usize::try_from(bytes).unwrap());
        let Standing::Intact(opcode, payload) = standing(frame) else { panic!("{frame:?}") };
        assert_eq!(frame.len(), payload.len() + 5);
        match opcode {
            b'A' | b'N' => assert!(payload.len() == 1 && b"HMC".contains(&payload[0])),
            b's' => assert!(matches!(payload.len(), 13 | 16)),
            _ => assert!(payload.is_empty() && b"hme".contains(&opcode)),
        }
        (*robot).sent.extend(&*frame);
        // It is the callback's now.
        frame.fill(0x55);
        do_more(robot);
    }
    -1
}

/// What is refused at any time.
pub unsafe fn nulls(robot: *const Robot) {
    unsafe {
        let (controller, byte) = ((*robot).controller, robot.cast::<c_void>());
        assert_eq!(dp_controller_init(null_mut(), (*robot).calls(), null_mut(), 0, 0), 1);
        assert_eq!(dp_controller_receive(null_mut(), byte, 1), -1);
        assert_eq!(dp_controller_receive(controller, null(), 1), -1);
        assert_eq!(dp_controller_receive(controller, byte, -1), -1);
        assert_eq!(dp_controller_poll(null_mut()), 1);
        assert_eq!(dp_controller_poll_idle(null_mut()), 1);
        assert_eq!(dp_controller_report(null_mut()), 1);
    }
}
