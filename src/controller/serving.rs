//! The firmware's own functions, called where the core's controller asks for them.

use core::ffi::c_void;
use core::mem::MaybeUninit;
use core::ptr::{with_exposed_provenance, with_exposed_provenance_mut};

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::{Calls, Controller};
use crate::memory::int;
use crate::payload::{position_to, report_from};
use crate::protocol::StatusReport;
use crate::sizes::DP_DATA_MAX_SIZE;
use deltarobot_protocols::deltarobot::controller::{Controller as Core, Decision, Request};
use deltarobot_protocols::deltarobot::{
    FRAME_OVERHEAD, Layout, Message, Opcode, PAYLOAD_MAX, Position, Report, encode, receiver_room,
};

/// What lies in a [`Controller`].
#[derive(Debug, FromBytes, Immutable, KnownLayout)]
pub(crate) struct State {
    pub(super) controller: Core<{ receiver_room(DP_DATA_MAX_SIZE) }>,
    /// Addresses of the calls and of usr.
    pub(super) calls: usize,
    pub(super) usr: usize,
    pub(super) layout: u8,
    /// Not 0: the end of an operation, and an error in one, are reported as the specification says.
    pub(super) reports_end: u8,
    pub(super) reports_error: u8,
}

/// A controller with functions of the firmware's. No reference to it lives while one of these runs: they may call the
/// library on it, and even initialize it again, without functions.
#[derive(Clone, Copy)]
pub(super) struct Served(*mut Controller);

impl Served {
    /// `None` for NULL, and where the functions are not there that are needed.
    ///
    /// # Safety
    ///
    /// controller is NULL, or points to a whole object, made by `dp_controller_init` or all zero, which nobody else
    /// touches as long as this lives.
    pub(super) unsafe fn new(controller: *mut Controller) -> Option<Self> {
        let served = Self(controller);
        let (calls, _) = if controller.is_null() { None } else { served.calls() }?;
        (calls.read.is_some() && calls.send.is_some()).then_some(served)
    }

    /// Looks at the state, or changes it.
    fn with<R>(self, step: impl FnOnce(&mut State) -> R) -> R {
        // SAFETY: not NULL and whole by the contract of new(); this is the only reference, as no step calls the
        // firmware.
        step(unsafe { &mut *self.0.cast() })
    }

    /// The functions, and usr.
    fn calls<'a>(self) -> Option<(&'a Calls, *mut c_void)> {
        let (calls, usr) = self.with(|state| (state.calls, state.usr));
        // SAFETY: NULL, or what was given to dp_controller_init, which has to stay there.
        let calls = unsafe { with_exposed_provenance::<Calls>(calls).as_ref() }?;
        Some((calls, with_exposed_provenance_mut(usr)))
    }

    /// Does one thing: reports the end of the operation, or answers one request. `false` when there is nothing to do.
    pub(super) fn act(self, idle: bool) -> bool {
        if self.with(|state| state.controller.is_active()) {
            let now = self.status();
            if let Some(end) = self.with(|state| state.controller.ended(&now)) {
                let is_asked_for = self.with(|state| match end {
                    Some(Opcode::GENERAL_ERR) => state.reports_error != 0,
                    _ => state.reports_end != 0,
                });
                if let Some(end) = end.filter(|_| is_asked_for) {
                    self.send(end, &[]);
                }
                self.report();
                return true;
            }
        }
        let request = self.with(|state| state.controller.request(idle));
        if let Some(request) = &request {
            self.answer(request);
        }
        request.is_some()
    }

    fn answer(self, request: &Request) {
        let now = self.status();
        let decision = self.with(|state| state.controller.decide(request, &now));
        let accepted = self.carry_out(&decision);
        if accepted {
            self.with(|state| state.controller.started(&decision));
        }
        if decision != Decision::Report {
            self.send(if accepted { Opcode::ACK } else { Opcode::NACK }, &[request.opcode.0]);
        }
        if decision != Decision::RefuseOnly {
            let now = self.report();
            self.with(|state| state.controller.reported(&now));
        }
    }

    /// Has the firmware do what was decided, and says whether it does.
    fn carry_out(self, decision: &Decision) -> bool {
        let Some((calls, usr)) = self.calls() else { return false };
        match decision {
            // SAFETY: this, and the two below, can be called with usr, as dp_controller_init asks.
            Decision::Home => calls.home.is_some_and(|home| unsafe { home(usr) } == 0),
            // SAFETY: see above.
            Decision::Cancel => calls.cancel.is_some_and(|cancel| unsafe { cancel(usr) } == 0),
            Decision::Move(target) => calls.r#move.is_some_and(|start| {
                let mut position = MaybeUninit::uninit();
                // SAFETY: see above; the position is ours, and filled in before it is read.
                unsafe {
                    position_to(position.as_mut_ptr(), *target);
                    start(position.as_ptr(), usr) == 0
                }
            }),
            Decision::Accept => true,
            Decision::Report | Decision::Refuse | Decision::RefuseOnly => false,
        }
    }

    /// Asks the firmware for the status.
    fn status(self) -> Report {
        let mut report = StatusReport { DA: 0.0, DB: 0.0, DC: 0.0, STAT: 0 };
        if let Some((Calls { read: Some(read), .. }, usr)) = self.calls() {
            // SAFETY: it can be called with usr, as dp_controller_init asks; the report is ours.
            unsafe { read(&raw mut report, usr) };
        }
        // SAFETY: the report is ours.
        unsafe { report_from(&raw const report) }.unwrap_or(Report::new(Position::UNKNOWN, 0))
    }

    /// Sends the status, and returns it.
    #[inline(never)] // That is smaller.
    pub(super) fn report(self) -> Report {
        let report = self.status();
        let mut payload = [0; PAYLOAD_MAX];
        let layout = Layout::of(self.with(|state| state.layout));
        let length = Message::StatusReport(report).write(layout, &mut payload);
        self.send(Opcode::STATUS_REPL, payload.get(..length).unwrap_or_default());
        report
    }

    fn send(self, opcode: Opcode, payload: &[u8]) {
        let mut frame = [MaybeUninit::<u8>::uninit(); PAYLOAD_MAX.wrapping_add(FRAME_OVERHEAD)];
        let length = encode(opcode, payload, &mut frame);
        if let (Some(length), Some((Calls { send: Some(send), .. }, usr))) = (length, self.calls()) {
            // SAFETY: it can be called with usr, as dp_controller_init asks; encode() has written so many bytes.
            unsafe { send(frame.as_mut_ptr().cast(), int(length), usr) };
        }
    }
}
