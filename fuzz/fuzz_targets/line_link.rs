//! Both ends of the line protocol's link: any calls in any order at any time, whatever the line makes of what is sent,
//! whatever the device's functions do, and with anything in the structs. While a session is as it was made, each
//! command ends once and in time.
#![no_main]

use std::collections::BTreeMap;
use std::ffi::{c_int, c_long, c_ulong};
use std::ptr::{null, null_mut};

use deltarobot::line_device::{self, *};
use deltarobot::line_host::{self, *};
use deltarobot::line_protocol::LineParam;
use deltarobot::line_protocol::message::olp_param_at;
use deltarobot::sizes::{OLP_DEVICES_MAX, OLP_LINE_MAX, OLP_WINDOW_MAX};
use deltarobot_fuzz::input::Input;
use deltarobot_fuzz::line_board::{Board, COMMAND_MAX, IDS, Table, an_event};
use deltarobot_fuzz::link::{self, Line, carry, fetch, give, in_range, later, run, written};
use deltarobot_fuzz::object::{Object, Plain};
use libfuzzer_sys::fuzz_target;

const COMMANDS: [&[u8]; 8] = [
    b"c=setswitch&state=1",
    b"c=get",
    b"c=again&n=12345",
    b"c=refused",
    b"c=unheard",
    b"c=get&text=%41+b&n=-1.5",
    b"c=linksetup&ack=on&windowsize=3",
    b"c=setswitch&state=1&for=two_and_forty_bytes",
];

fuzz_target!(|input: &[u8]| run::<Ends>(input));

struct Ends {
    host: Object<Host>,
    device: Object<line_device::Device>,
    /// Where a device's pointers lie.
    pointers: std::ops::Range<usize>,
    table: Table,
    board: Box<Board>,
    to_device: Line,
    now: c_ulong,
    /// Commands that have not ended, and whether they were acknowledged.
    open: BTreeMap<c_int, bool>,
    /// Whether the host's memory is as the library left it.
    sound: bool,
    /// Whether its settings are the default ones.
    plain: bool,
}

impl link::World for Ends {
    fn new(input: &mut Input) -> Self {
        let device = Object::default();
        let table = Table::new(input);
        let now = c_ulong::from_le_bytes(input.bytes::<8>());
        let mut board = Board::new(device.ptr(), now);
        // Not made yet: all zero is refused.
        unsafe {
            assert_eq!(olp_device_poll(device.ptr(), now), 1);
            assert_eq!(olp_device_init(device.ptr(), table.ptr(), board.usr()), 0);
        }
        Self {
            host: Object::default(),
            pointers: device.places_of([table.ptr().cast(), board.usr()]),
            device,
            table,
            board,
            to_device: Line::new(),
            now,
            open: BTreeMap::new(),
            sound: true,
            plain: true,
        }
    }

    fn step(&mut self, input: &mut Input) {
        let choice = input.byte();
        let variant = choice >> 5;
        self.board.now = self.now;
        match choice % 21 {
            0 | 1 => self.send(input, variant),
            2 => self.setup(input, variant),
            3 | 4 => {
                let (bytes, _) = carry(&mut self.board.sent, input, variant);
                self.host_receive(&bytes);
            }
            5 | 6 => {
                let (bytes, _) = carry(&mut self.to_device, input, variant);
                self.device_receive(&bytes);
            }
            7 => self.host_receive(&raw(input, variant)),
            8 => self.device_receive(&raw(input, variant)),
            9 => self.host_poll(usize::from(variant)),
            10 => self.host_output(usize::from(input.byte())),
            11 => self.device_poll(usize::from(variant)),
            12 => self.wait(input, variant),
            13 => self.event(input, variant),
            14 => self.device_calls(input, variant),
            15 => self.host_init(input, variant),
            16 => self.scribble(input, variant),
            17 => self.nulls(),
            18 => self.board.deeds.extend(input.bytes::<4>()),
            _ => self.exchange(),
        }
    }

    fn look(&self) {
        let mut link = HostLink::zero();
        let mut known = Box::new(line_host::HostDevice {
            id: [1; OLP_HOST_ID_MAX as usize + 1],
            r#type: [1; OLP_HOST_TYPE_MAX as usize + 1],
            name: [1; OLP_HOST_NAME_MAX as usize + 1],
            version: [1; OLP_HOST_VERSION_MAX as usize + 1],
            pos: 0,
            cut: 0,
        });
        unsafe {
            assert_eq!(olp_host_get_link(self.host.ptr(), &raw mut link), 0);
            in_range(olp_host_next_deadline(self.host.ptr(), self.now));
            assert_eq!(olp_host_get_health(self.host.ptr(), &raw mut *Box::new(HostHealth::zero())), 0);
            assert_eq!(olp_device_get_health(self.device.ptr(), &raw mut *Box::new(DeviceHealth::zero())), 0);
            assert_eq!(olp_host_get_device(self.host.ptr(), -1, &raw mut *known), 11);
            assert_eq!(olp_host_get_device(self.host.ptr(), OLP_DEVICES_MAX as c_int, &raw mut *known), 11);
            if olp_host_get_device(self.host.ptr(), 0, &raw mut *known) == 0 {
                for text in [&known.id[..], &known.r#type, &known.name, &known.version] {
                    assert!(text.contains(&0) || !self.sound);
                }
            }
        }
    }

    fn everything_ends(&mut self) {
        if !self.sound || !self.plain {
            return;
        }
        for _ in 0..16 * OLP_WINDOW_MAX + 16 {
            self.host_poll(usize::MAX);
            self.host_output(COMMAND_MAX * (OLP_WINDOW_MAX + 1));
            let deadline = unsafe { olp_host_next_deadline(self.host.ptr(), self.now) };
            if self.open.is_empty() {
                return;
            }
            assert!(deadline >= 0, "commands are open, and nothing is to be done");
            self.now = self.now.wrapping_add(deadline as c_ulong);
        }
        panic!("{} commands never end", self.open.len());
    }
}

impl Ends {
    /// As much as both ends have to say to each other now, over a good line.
    fn exchange(&mut self) {
        for _ in 0..3 {
            self.host_poll(usize::MAX);
            self.host_output(1024);
            let bytes: Vec<_> = self.to_device.drain(..).collect();
            self.device_receive(&bytes);
            self.device_poll(8);
            let bytes: Vec<_> = self.board.sent.drain(..).collect();
            self.host_receive(&bytes);
        }
        self.host_poll(usize::MAX);
    }

    fn send(&mut self, input: &mut Input, variant: u8) {
        let which = input.byte();
        let command: Box<[u8]> = match variant {
            7 => input.slice(usize::from(which)).into(),
            _ => COMMANDS[usize::from(which) % COMMANDS.len()].into(),
        };
        let id = id(input, variant);
        let handle = unsafe {
            olp_host_send(self.host.ptr(), command.as_ptr().cast(), command.len() as c_int, id.as_ptr().cast())
        };
        self.queued(handle);
    }

    fn setup(&mut self, input: &mut Input, variant: u8) {
        let id = id(input, variant);
        let [ack, checksum] = input.bytes().map(|byte| c_int::from(byte % 3) - 1);
        let windowsize = match input.byte() % 4 {
            0 => -1,
            1 => c_long::from(input.int()),
            _ => c_long::from(input.byte() % 12),
        };
        let handle = unsafe { olp_host_setup(self.host.ptr(), id.as_ptr().cast(), ack, checksum, windowsize) };
        self.queued(handle);
    }

    fn queued(&mut self, handle: c_int) {
        assert!((1..=32767).contains(&handle) || [-1, -5, -8, -9].contains(&handle), "{handle}");
        if self.sound {
            let full = self.open.len() == OLP_WINDOW_MAX;
            assert!(if full { handle < 0 } else { handle != -5 }, "{handle}");
            assert!(handle < 0 || self.open.insert(handle, false).is_none());
        }
    }

    /// Gives bytes to the host, and fetches events until it has taken them.
    fn host_receive(&mut self, bytes: &[u8]) {
        let receive = |ends: &Self, bytes, count| unsafe { olp_host_receive(ends.host.ptr(), bytes, count, ends.now) };
        let all = give(self, bytes, receive, |ends| ends.host_poll(usize::MAX));
        assert!(all || !self.sound, "the host takes no bytes");
    }

    fn host_poll(&mut self, times: usize) {
        // A line's, and two for each command.
        let most = 16 + 4 * OLP_WINDOW_MAX;
        let poll = |ends: &Self, event: *mut HostEvent| unsafe { olp_host_poll(ends.host.ptr(), ends.now, event) };
        let ended = fetch(self, times, most, poll, Self::happened);
        assert!(ended || !self.sound, "there is no end of events");
    }

    fn happened(&mut self, event: &HostEvent) {
        let link = &event.link;
        assert!(link.ack | 1 == 1 && link.checksum | 1 == 1 && link.windowsize >= 1, "{link:?}");
        assert!((0..=8).contains(&event.kind) && (event.outcome != 0) == (event.kind == 4));
        assert!((0..=5).contains(&event.outcome) && (-1..OLP_DEVICES_MAX as c_int).contains(&event.device));
        let message = &event.message;
        if message.length != 0 {
            let line = unsafe { std::slice::from_raw_parts(message.line.cast(), message.length as usize) };
            assert!(self.host.holds(line) && line.len() <= OLP_LINE_MAX && line.starts_with(b"c"));
            for index in 0..message.count {
                let mut param = LineParam::zero();
                assert_eq!(unsafe { olp_param_at(message, index, &raw mut param) }, 0);
            }
        }
        if !self.sound {
            return;
        }
        assert!((event.lost != 0) == (event.kind == 6) && (0..=127).contains(&event.lost));
        match event.kind {
            3 => assert_eq!(self.open.insert(event.handle, true), Some(false), "acknowledged once"),
            4 => assert!(self.open.remove(&event.handle).is_some(), "ended once"),
            7 => assert!(event.handle == 0 || self.open.contains_key(&event.handle)),
            _ => assert_eq!(event.handle, 0),
        }
    }

    fn host_output(&mut self, cap: usize) {
        let lines = written(cap, true, |room, cap| unsafe { olp_host_output(self.host.ptr(), room, cap, self.now) });
        if self.sound {
            for line in lines.split_inclusive(|byte| *byte == b'\n') {
                assert!(line.len() <= COMMAND_MAX && line.starts_with(b"c=") && line.ends_with(b"\n"));
                assert!(line[..line.len() - 1].iter().all(|byte| (0x20..0x7F).contains(byte)));
            }
        }
        self.to_device.extend(lines);
    }

    fn device_receive(&mut self, bytes: &[u8]) {
        let receive =
            |ends: &Self, bytes, count| unsafe { olp_device_receive(ends.device.ptr(), bytes, count, ends.now) };
        let all = give(self, bytes, receive, |ends| ends.device_poll(8));
        assert!(all || !self.board.sound, "the device takes no bytes");
    }

    fn device_poll(&mut self, times: usize) {
        for _ in 0..times {
            let rc = unsafe { olp_device_poll(self.device.ptr(), self.now) };
            assert!([0, 1, 5, 6, 8, 9, 10].contains(&rc), "{rc}");
            assert!(rc != 5 || !self.board.sound);
            if rc == 6 {
                return;
            }
        }
    }

    fn wait(&mut self, input: &mut Input, variant: u8) {
        let deadline = unsafe { olp_host_next_deadline(self.host.ptr(), self.now) };
        self.now = later(self.now, deadline, input, variant);
    }

    fn event(&mut self, input: &mut Input, variant: u8) {
        unsafe { an_event(self.device.ptr(), input.byte(), &id(input, variant)) };
    }

    fn device_calls(&mut self, input: &mut Input, variant: u8) {
        let device = self.device.ptr();
        unsafe {
            match variant {
                0..4 => {
                    let window = input.int();
                    let rc = olp_device_linksetup(device, input.int(), input.int(), window);
                    assert_eq!(rc, c_int::from(!(1..=OLP_WINDOW_MAX as c_int).contains(&window)));
                }
                4 | 5 => assert_eq!(olp_device_restart(device), 0),
                _ => self.device_init(),
            }
        }
    }

    fn device_init(&mut self) {
        assert_eq!(unsafe { olp_device_init(self.device.ptr(), self.table.ptr(), self.board.usr()) }, 0);
        self.board.sound = true;
    }

    fn host_init(&mut self, input: &mut Input, variant: u8) {
        let settings = HostSettings {
            timeout_ms: c_ulong::from_le_bytes(input.bytes()) >> (variant * 8),
            answer_ms: c_ulong::from(input.byte()) * 10,
            repeat_ms: c_ulong::from_le_bytes(input.bytes()) >> (variant * 8),
            repeats: input.int(),
            recognises: c_int::from(input.byte() % 2),
            baud: c_ulong::from_le_bytes(input.bytes()) >> (variant * 8),
            receive_room: input.int(),
        };
        self.plain = variant == 0;
        let settings = if self.plain { null() } else { &raw const settings };
        assert_eq!(unsafe { olp_host_init(self.host.ptr(), settings) }, 0);
        self.open.clear();
        self.sound = true;
    }

    /// Goes beyond what is promised, but for the device's pointers: no memory but the object's is touched even then.
    fn scribble(&mut self, input: &mut Input, variant: u8) {
        match variant {
            0 | 1 => {
                self.host.scribble(input, 0..0);
                self.sound = false;
            }
            2 | 3 => {
                self.device.scribble(input, self.pointers.clone());
                self.board.sound = false;
            }
            4 => self.device_init(),
            _ => self.host_init(&mut Input(&[]), 0),
        }
    }

    fn nulls(&self) {
        let (host, device, byte) = (self.host.ptr(), self.device.ptr(), c"c=get".as_ptr());
        unsafe {
            assert_eq!(olp_host_init(null_mut(), null()), 1);
            assert_eq!(olp_host_send(host, null(), 5, byte), -1);
            assert_eq!(olp_host_send(host, byte, -1, byte), -1);
            assert_eq!(olp_host_send(host, byte, 5, null()), -1);
            assert_eq!(olp_host_receive(host, null(), 1, self.now), -1);
            assert_eq!(olp_host_output(host, null_mut(), 1, self.now), -1);
            assert_eq!(olp_host_poll(host, self.now, null_mut()), 1);
            assert_eq!(olp_host_next_deadline(null(), self.now), -1);
            assert_eq!(olp_device_receive(device, byte.cast(), -1, self.now), -1);
            assert_eq!(olp_device_event(device, null_mut(), byte), 1);
            assert_eq!(olp_device_init(null_mut(), self.table.ptr(), null_mut()), 1);
            assert_eq!(olp_device_poll(null_mut(), self.now), 1);
        }
    }
}

/// The id of a device, known or not.
fn id(input: &mut Input, variant: u8) -> Box<[u8]> {
    let which = input.byte();
    match variant {
        6 => {
            let text = input.slice(usize::from(which % 64)).iter().copied().filter(|byte| *byte != 0);
            text.chain([0]).collect()
        }
        _ => IDS[usize::from(which) % IDS.len()].to_bytes_with_nul().into(),
    }
}

/// Bytes that nobody has sent, but could have.
fn raw(input: &mut Input, variant: u8) -> Vec<u8> {
    const LINES: [&[u8]; 6] = [
        b"c=welcome&id=9o5qzg&type=T&pos=1\n",
        b"c=linksetup_resp&windowsize=200&ack=on&checksum=fletcher16\n",
        b"c=onerror&code=checksum&t=3\n",
        b"c=ack&t=0\n",
        b"c=get_resp&id=9o5qzg&t=",
        b"c=linksetup&ack=off&checksum=none&id=sf6z34&t=7\n",
    ];
    let mut bytes = LINES.get(usize::from(variant)).map_or_else(Vec::new, |line| line.to_vec());
    let count = usize::from(input.byte() % 64);
    bytes.extend(input.slice(count));
    if variant == 7 {
        // More than a line may have.
        bytes = bytes.iter().copied().cycle().take(300).collect();
    }
    bytes
}
