//! What a controller's firmware does with received bytes: answers each request with an acknowledgement.
#![no_std]

use deltarobot_protocols::deltarobot::{NoFrame, Opcode, Receiver, encode, receiver_room};

/// The longest payload that is received: that of a status report.
const LONGEST: usize = 16;

/// A controller. All of its memory is this struct.
pub struct Controller {
    receiver: Receiver<{ receiver_room(LONGEST) }>,
}

impl Controller {
    /// One that has received nothing.
    pub const fn new() -> Self {
        Self { receiver: Receiver::new() }
    }

    /// Takes a received byte, and sends what is to be answered.
    pub fn receive(&mut self, byte: u8, mut send: impl FnMut(&[u8])) {
        if self.receiver.byte(byte) != Ok(true) {
            return;
        }
        loop {
            match self.receiver.next() {
                Ok(frame) => {
                    let mut answer = [0_u8; 6];
                    if let Some(length) = encode(Opcode::ACK, &[frame.opcode.0], &mut answer) {
                        send(&answer[..length]);
                    }
                }
                Err(NoFrame::Waiting | NoFrame::Garbage) => return,
            }
        }
    }
}

/// Called by the interrupt of the serial port; `uart_write` is the board's.
///
/// # Safety
///
/// controller is one, which nobody else touches meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn on_byte(controller: *mut Controller, byte: u8, uart_write: extern "C" fn(*const u8, usize)) {
    // SAFETY: the same contract.
    let controller = unsafe { &mut *controller };
    controller.receive(byte, |bytes| uart_write(bytes.as_ptr(), bytes.len()));
}

#[panic_handler]
fn stop(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
