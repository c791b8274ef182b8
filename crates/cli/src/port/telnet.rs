//! The client's side of RFC 2217: a serial port behind telnet.

const IAC: u8 = 255;
const DONT: u8 = 254;
const DO: u8 = 253;
const WONT: u8 = 252;
const WILL: u8 = 251;
/// What lies between these is for an option.
const SB: u8 = 250;
const SE: u8 = 240;

const BINARY: u8 = 0;
const SUPPRESS_GO_AHEAD: u8 = 3;
const COM_PORT: u8 = 44;

const SET_BAUDRATE: u8 = 1;
const SET_DATASIZE: u8 = 2;
const SET_PARITY: u8 = 3;
const SET_STOPSIZE: u8 = 4;
const SET_CONTROL: u8 = 5;
const PURGE_DATA: u8 = 12;
/// More of what a server says about an option is not kept: what matters here is shorter.
const SUB_MAX: usize = 16;
/// The server's answers have numbers that are higher by this.
const ANSWER: u8 = 100;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Data,
    /// Behind IAC.
    Command,
    /// Behind WILL, WONT, DO or DONT.
    Option(u8),
    Sub,
    /// Behind IAC in it.
    SubCommand,
}

/// The state of a connection.
#[derive(Debug)]
pub(super) struct Telnet {
    asked: u32,
    state: State,
    sub: Vec<u8>,
    /// What was answered already, so that nothing is answered in circles.
    said: Vec<(u8, u8)>,
    baud: Option<u32>,
    is_refused: bool,
}

impl Telnet {
    pub(super) fn new(baud: u32) -> Self {
        let said = vec![(WILL, COM_PORT), (WILL, BINARY), (DO, BINARY), (DO, SUPPRESS_GO_AHEAD)];
        Self { asked: baud, state: State::Data, sub: Vec::new(), said, baud: None, is_refused: false }
    }

    /// What the client begins with: 8 data bits, no parity, one stop bit, no flow control.
    pub(super) fn request(&self, dtr: Option<bool>, rts: Option<bool>) -> Vec<u8> {
        let mut out: Vec<_> = self.said.iter().flat_map(|(verb, option)| [IAC, *verb, *option]).collect();
        let mut set = |command, value: &[u8]| {
            out.extend([IAC, SB, COM_PORT, command]);
            out.extend(Self::escaped(value));
            out.extend([IAC, SE]);
        };
        set(SET_DATASIZE, &[8]);
        set(SET_PARITY, &[1]);
        set(SET_STOPSIZE, &[1]);
        set(SET_CONTROL, &[1]);
        if let Some(is_on) = dtr {
            set(SET_CONTROL, &[if is_on { 8 } else { 9 }]);
        }
        if let Some(is_on) = rts {
            set(SET_CONTROL, &[if is_on { 11 } else { 12 }]);
        }
        set(PURGE_DATA, &[1]);
        set(SET_BAUDRATE, &self.asked.to_be_bytes());
        out
    }

    /// The speed that the server has set, once it has said so.
    pub(super) const fn baud(&self) -> Option<u32> {
        self.baud
    }

    /// Whether the server knows nothing of serial ports.
    pub(super) const fn is_refused(&self) -> bool {
        self.is_refused
    }

    /// Moves the data among the bytes to their beginning. Returns how many there are, and what is to be answered.
    pub(super) fn take(&mut self, bytes: &mut [u8]) -> (usize, Vec<u8>) {
        let (mut data, mut answer) = (Vec::with_capacity(bytes.len()), Vec::new());
        for byte in bytes.iter().copied() {
            self.state = match (self.state, byte) {
                (State::Data, IAC) => State::Command,
                (State::Data, _) | (State::Command, IAC) => {
                    data.push(byte);
                    State::Data
                }
                (State::Command, SB) => {
                    self.sub.clear();
                    State::Sub
                }
                (State::Command, DO | DONT | WILL | WONT) => State::Option(byte),
                (State::Command, _) => State::Data,
                (State::Option(verb), option) => {
                    self.negotiate(verb, option, &mut answer);
                    State::Data
                }
                (State::Sub, IAC) => State::SubCommand,
                (State::Sub, _) | (State::SubCommand, IAC) => {
                    if self.sub.len() < SUB_MAX {
                        self.sub.push(byte);
                    }
                    State::Sub
                }
                (State::SubCommand, _) => {
                    self.notice();
                    State::Data
                }
            };
        }
        for (place, byte) in bytes.iter_mut().zip(&data) {
            *place = *byte;
        }
        (data.len(), answer)
    }

    fn negotiate(&mut self, verb: u8, option: u8, answer: &mut Vec<u8>) {
        let is_wanted = matches!(option, BINARY | SUPPRESS_GO_AHEAD | COM_PORT);
        let verb = match verb {
            DO if is_wanted => WILL,
            DO => WONT,
            WILL if is_wanted => DO,
            WILL => DONT,
            _ => {
                self.is_refused |= option == COM_PORT && verb == DONT;
                return;
            }
        };
        if !self.said.contains(&(verb, option)) {
            self.said.push((verb, option));
            answer.extend([IAC, verb, option]);
        }
    }

    fn notice(&mut self) {
        if let [COM_PORT, command, baud @ ..] = self.sub.as_slice()
            && *command == SET_BAUDRATE + ANSWER
        {
            self.baud = baud.try_into().ok().map(u32::from_be_bytes);
        }
    }

    /// Data, of which one byte has to be doubled.
    pub(super) fn escaped(bytes: &[u8]) -> Vec<u8> {
        bytes.iter().flat_map(|byte| std::iter::repeat_n(*byte, if *byte == IAC { 2 } else { 1 })).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{COM_PORT, DO, IAC, SB, SE, Telnet, WILL, WONT};

    #[test]
    fn data_and_commands_in_any_pieces() {
        let stream = [
            &b"a"[..],
            &[IAC, IAC],
            &[IAC, DO, COM_PORT, IAC, DO, 31, IAC, DO, 31],
            &[IAC, SB, COM_PORT, 101, 0, 0, IAC, IAC, 7, IAC, SE],
            b"b",
        ]
        .concat();
        for piece in 1..stream.len() {
            let (mut telnet, mut data, mut answers) = (Telnet::new(9600), Vec::new(), Vec::new());
            for bytes in stream.chunks(piece) {
                let mut bytes = bytes.to_vec();
                let (count, answer) = telnet.take(&mut bytes);
                data.extend_from_slice(&bytes[..count]);
                answers.extend(answer);
            }
            assert_eq!((data.as_slice(), answers.as_slice()), (b"a\xFFb".as_slice(), [IAC, WONT, 31].as_slice()));
            assert_eq!(telnet.baud(), Some(0xFF07));
        }
        assert!(Telnet::new(9600).request(None, None).starts_with(&[IAC, WILL, COM_PORT]));
    }

    #[test]
    fn a_server_that_never_ends_fills_no_memory() {
        let mut telnet = Telnet::new(9600);
        telnet.take(&mut [IAC, SB, COM_PORT, 101]);
        for _ in 0..1000 {
            telnet.take(&mut [7; 1000]);
        }
        assert!(telnet.sub.capacity() < 100);
        telnet.take(&mut [IAC, SE]);
        assert_eq!(telnet.baud(), None);
        for option in 0..=254 {
            for _ in 0..10 {
                telnet.take(&mut [IAC, DO, option, IAC, WILL, option]);
            }
        }
        assert!(telnet.said.len() <= 512);
    }
}
