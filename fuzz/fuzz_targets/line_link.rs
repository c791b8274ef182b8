//! Both ends of the line protocol's link: any calls in any order at any time, whatever the line makes of what is sent,
//! whatever the device's functions do, and with anything in the structs. While a session is as it was made, each
//! command ends once and in time.
#![no_main]

use std::collections::{BTreeMap, VecDeque};
use std::ffi::{CStr, c_char, c_int, c_long, c_ulong, c_void};
use std::ptr::{null, null_mut};

use deltarobot_fuzz::input::Input;
use deltarobot_fuzz::line_abi::*;
use deltarobot_fuzz::object::Object;
use libfuzzer_sys::fuzz_target;

const COMMAND_MAX: usize = 64;
const IDS: [&CStr; 5] = [c"sf6z34", c"9o5qzg", c"a.b_c-d", c"nobody", c"%&= \xC3"];
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

fuzz_target!(|input: &[u8]| {
    let mut input = Input(input);
    let mut world = World::new(&mut input);
    while !input.is_empty() {
        world.step(&mut input);
    }
    world.everything_ends();
});

/// What the functions of a device's table work with.
struct Board {
    device: *mut Device,
    now: c_ulong,
    sent: VecDeque<u8>,
    /// What they do besides, one after the other.
    deeds: VecDeque<u8>,
    depth: u8,
    sound: bool,
}

struct World {
    host: Object<Host>,
    device: Object<Device>,
    /// Where a device's pointers lie.
    pointers: usize,
    _infos: Vec<DeviceInfo>,
    _commands: Vec<Command>,
    table: Box<DeviceTable>,
    board: Box<Board>,
    to_device: VecDeque<u8>,
    now: c_ulong,
    /// Commands that have not ended, and whether they were acknowledged.
    open: BTreeMap<c_int, bool>,
    /// Whether the host's memory is as the library left it.
    sound: bool,
    /// Whether its settings are the default ones.
    plain: bool,
}

impl World {
    fn new(input: &mut Input) -> Self {
        let host = Object::default();
        let device = Object::default();
        let infos: Vec<_> = [(IDS[0], 0, null()), (IDS[1], 1, c"A name, 100 %".as_ptr()), (IDS[2], -7, c"".as_ptr())]
            .map(|(id, pos, name)| DeviceInfo { id: id.as_ptr(), kind: c"Kind".as_ptr(), pos, name, version: name })
            .into();
        let command = |id, name: &CStr, run| Command { id, name: name.as_ptr(), run };
        let commands = vec![
            command(IDS[1].as_ptr(), c"setswitch", Some(run as RunFunc)),
            command(null(), c"get", Some(run as RunFunc)),
            command(null(), c"again", Some(run as RunFunc)),
            command(null(), c"refused", None),
        ];
        let table = Box::new(DeviceTable {
            devices: infos.as_ptr(),
            device_count: 1 + c_int::from(input.byte() % 3),
            commands: commands.as_ptr(),
            command_count: 4,
            send: Some(send),
            repeat_ms: c_ulong::from(input.byte()) * 20,
        });
        let now = c_ulong::from_le_bytes(input.bytes::<8>());
        let mut board = Box::new(Board {
            device: device.ptr(),
            now,
            sent: VecDeque::new(),
            deeds: VecDeque::new(),
            depth: 0,
            sound: true,
        });
        // Not made yet: all zero is refused.
        unsafe {
            assert_eq!(olp_device_poll(device.ptr(), now), 1);
            assert_eq!(olp_device_init(device.ptr(), &raw const *table, (&raw mut *board).cast()), 0);
        }
        let pointers = device.place_of((&raw const *table).cast());
        let (to_device, open) = (VecDeque::new(), BTreeMap::new());
        Self {
            host,
            device,
            pointers,
            _infos: infos,
            _commands: commands,
            table,
            board,
            to_device,
            now,
            open,
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
                let bytes = carry(&mut self.board.sent, input, variant);
                self.host_receive(&bytes);
            }
            5 | 6 => {
                let bytes = carry(&mut self.to_device, input, variant);
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
        self.look();
    }

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
        let mut rest = Box::<[u8]>::from(bytes);
        for _ in 0..=2 * bytes.len() {
            let taken =
                unsafe { olp_host_receive(self.host.ptr(), rest.as_ptr().cast(), rest.len() as c_int, self.now) };
            let taken = usize::try_from(taken).unwrap();
            rest = rest[taken..].into();
            if rest.is_empty() {
                return;
            }
            self.host_poll(usize::MAX);
        }
        assert!(!self.sound, "the host takes no bytes");
    }

    fn host_poll(&mut self, times: usize) {
        // A line's, and two for each command.
        let most = 16 + 4 * OLP_WINDOW_MAX;
        for _ in 0..times.min(most) {
            let mut event = Box::new(HostEvent { kind: -1, ..HostEvent::default() });
            let rc = unsafe { olp_host_poll(self.host.ptr(), self.now, &raw mut *event) };
            assert_eq!(rc, if event.kind == 0 { 6 } else { 0 });
            self.happened(&event);
            if event.kind == 0 {
                return;
            }
        }
        assert!(times < most || !self.sound, "there is no end of events");
    }

    fn happened(&mut self, event: &HostEvent) {
        let link = event.link;
        assert!(link.ack | 1 == 1 && link.checksum | 1 == 1 && link.windowsize >= 1, "{link:?}");
        assert!((0..=8).contains(&event.kind) && (event.outcome != 0) == (event.kind == 4));
        assert!((0..=5).contains(&event.outcome) && (-1..OLP_DEVICES_MAX as c_int).contains(&event.device));
        let message = &event.message;
        if message.length != 0 {
            let line = unsafe { std::slice::from_raw_parts(message.line.cast(), message.length as usize) };
            assert!(self.host.holds(line) && line.len() <= OLP_LINE_MAX && line.starts_with(b"c"));
            for index in 0..message.count {
                let mut param = Param::default();
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
        let mut room = vec![0x55_u8; cap].into_boxed_slice();
        let length = unsafe { olp_host_output(self.host.ptr(), room.as_mut_ptr().cast(), cap as c_int, self.now) };
        let (lines, rest) = room.split_at(usize::try_from(length).unwrap());
        assert!(rest.iter().all(|byte| *byte == 0x55));
        if self.sound {
            for line in lines.split_inclusive(|byte| *byte == b'\n') {
                assert!(line.len() <= COMMAND_MAX && line.starts_with(b"c=") && line.ends_with(b"\n"));
                assert!(line[..line.len() - 1].iter().all(|byte| (0x20..0x7F).contains(byte)));
            }
        }
        self.to_device.extend(lines);
    }

    fn device_receive(&mut self, bytes: &[u8]) {
        let mut rest = Box::<[u8]>::from(bytes);
        for _ in 0..=2 * bytes.len() {
            let taken =
                unsafe { olp_device_receive(self.device.ptr(), rest.as_ptr().cast(), rest.len() as c_int, self.now) };
            let taken = usize::try_from(taken).unwrap();
            rest = rest[taken..].into();
            if rest.is_empty() {
                return;
            }
            self.device_poll(8);
        }
        assert!(!self.board.sound, "the device takes no bytes");
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
        let time = match variant {
            0 => c_ulong::from_le_bytes(input.bytes::<8>()),
            1 => (c_ulong::from(input.byte()) << 24).wrapping_neg(),
            2..4 => c_ulong::from(input.byte()) * 10,
            4 => deadline.max(1) as c_ulong - 1,
            _ => deadline.max(0) as c_ulong,
        };
        self.now = self.now.wrapping_add(time);
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
        let usr = (&raw mut *self.board).cast();
        assert_eq!(unsafe { olp_device_init(self.device.ptr(), &raw const *self.table, usr) }, 0);
        self.board.sound = true;
    }

    fn host_init(&mut self, input: &mut Input, variant: u8) {
        let settings = HostSettings {
            timeout_ms: c_ulong::from_le_bytes(input.bytes()) >> (variant * 8),
            answer_ms: c_ulong::from(input.byte()) * 10,
            repeat_ms: c_ulong::from_le_bytes(input.bytes()) >> (variant * 8),
            repeats: input.int(),
            recognises: c_int::from(input.byte() % 2),
        };
        self.plain = variant == 0;
        let settings = if self.plain { null() } else { &raw const settings };
        assert_eq!(unsafe { olp_host_init(self.host.ptr(), settings) }, 0);
        self.open.clear();
        self.sound = true;
    }

    /// Goes beyond what is promised, but for the device's pointers: no memory but the object's is touched even then.
    fn scribble(&mut self, input: &mut Input, variant: u8) {
        let at = usize::from(u16::from_le_bytes(input.bytes()));
        let length = usize::from(input.byte());
        let count = 1 + usize::from(input.byte() % 16);
        let bytes = input.slice(count);
        match variant {
            0 | 1 => {
                self.host.scribble(at % size_of::<Host>(), length, bytes, 0..0);
                self.sound = false;
            }
            2 | 3 => {
                let pointers = self.pointers..self.pointers + 2 * size_of::<*const c_void>();
                self.device.scribble(at % size_of::<Device>(), length, bytes, pointers);
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
            assert_eq!(olp_device_init(null_mut(), &raw const *self.table, null_mut()), 1);
            assert_eq!(olp_device_poll(null_mut(), self.now), 1);
        }
    }

    /// What can be asked at any time.
    fn look(&self) {
        let deadline = unsafe { olp_host_next_deadline(self.host.ptr(), self.now) };
        assert!((-1..1 << 32).contains(&deadline), "{deadline}");
        let mut link = Link::default();
        let mut known =
            Box::new(HostDevice { id: [1; 16], kind: [1; 48], name: [1; 32], version: [1; 16], pos: 0, cut: 0 });
        unsafe {
            assert_eq!(olp_host_get_link(self.host.ptr(), &raw mut link), 0);
            assert!(!olp_host_get_health(self.host.ptr()).is_null());
            assert!(!olp_device_get_health(self.device.ptr()).is_null());
            assert_eq!(olp_host_get_device(self.host.ptr(), -1, &raw mut *known), 11);
            assert_eq!(olp_host_get_device(self.host.ptr(), OLP_DEVICES_MAX as c_int, &raw mut *known), 11);
            if olp_host_get_device(self.host.ptr(), 0, &raw mut *known) == 0 {
                for text in [&known.id[..], &known.kind, &known.name, &known.version] {
                    assert!(text.contains(&0) || !self.sound);
                }
            }
        }
    }

    /// With nobody at the other end, all that was sent ends by its deadlines.
    fn everything_ends(&mut self) {
        if !self.sound || !self.plain {
            return;
        }
        for _ in 0..16 * OLP_WINDOW_MAX + 16 {
            self.host_poll(usize::MAX);
            self.host_output(COMMAND_MAX * (OLP_WINDOW_MAX + 1));
            let deadline = unsafe { olp_host_next_deadline(self.host.ptr(), self.now) };
            assert_eq!(deadline < 0, self.open.is_empty());
            if deadline < 0 {
                return;
            }
            self.now = self.now.wrapping_add(deadline as c_ulong);
        }
        panic!("{} commands never end", self.open.len());
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

/// Takes bytes from a line, which may do something to them.
fn carry(line: &mut VecDeque<u8>, input: &mut Input, variant: u8) -> Vec<u8> {
    let count = match usize::from(input.byte()) {
        0 => line.len(),
        count => count.min(line.len()),
    };
    let mut bytes: Vec<_> = line.drain(..count).collect();
    if variant >= 4 && !bytes.is_empty() {
        let at = usize::from(input.byte()) % bytes.len();
        match variant {
            4 => drop(bytes.remove(at)),
            5 => bytes[at] ^= 1 << (input.byte() % 8),
            6 => bytes.truncate(at),
            _ => bytes.extend_from_within(at..),
        }
    }
    bytes
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

unsafe fn an_event(device: *mut Device, how: u8, id: &[u8]) {
    let mut room = vec![0x55_u8; usize::from(how)].into_boxed_slice();
    let mut event = Encoder::default();
    unsafe {
        olp_begin(&raw mut event, room.as_mut_ptr().cast(), room.len() as c_int, c"info".as_ptr());
        olp_add_int(&raw mut event, c"n".as_ptr(), c_long::from(how) << (how % 24));
        let rc = olp_device_event(device, &raw mut event, id.as_ptr().cast::<c_char>());
        assert!([0, 1, 5, 9].contains(&rc), "{rc}");
    }
}

/// What the functions of a table may do, besides what they are for.
unsafe fn do_more(board: *mut Board) {
    unsafe {
        let device = (*board).device;
        if (*board).depth >= 4 {
            return;
        }
        let Some(deed) = (*board).deeds.pop_front() else { return };
        (*board).depth += 1;
        let line = b"c=get&id=9o5qzg&t=5\n";
        match deed % 8 {
            0 => drop(olp_device_restart(device)),
            1 => drop(olp_device_linksetup(device, 1, c_int::from(deed & 8), 1)),
            2 => {
                let taken = olp_device_receive(device, line.as_ptr().cast(), line.len() as c_int, (*board).now);
                assert!((0..=line.len() as c_int).contains(&taken));
            }
            3 => {
                let rc = olp_device_poll(device, (*board).now);
                assert!([0, 5, 6].contains(&rc) || !(*board).sound, "{rc}");
            }
            4 => an_event(device, deed, IDS[1].to_bytes_with_nul()),
            _ => (),
        }
        (*board).depth -= 1;
    }
}

unsafe extern "C" fn send(line: *const c_void, bytes: c_int, usr: *mut c_void) -> c_int {
    let board: *mut Board = usr.cast();
    unsafe {
        let line = std::slice::from_raw_parts(line.cast::<u8>(), usize::try_from(bytes).unwrap());
        if (*board).sound {
            assert!(line.len() <= OLP_REPLY_MAX.max(255) && line.starts_with(b"c="));
            assert_eq!(line.iter().position(|byte| *byte == b'\n'), Some(line.len() - 1));
        }
        (*board).sent.extend(line);
        do_more(board);
    }
    bytes
}

unsafe extern "C" fn run(command: *const Message, answer: *mut Encoder, usr: *mut c_void) -> c_int {
    let board: *mut Board = usr.cast();
    unsafe {
        let line = std::slice::from_raw_parts((*command).line.cast::<u8>(), (*command).length as usize);
        assert!(line.len() < COMMAND_MAX && (*command).count > 0);
        for index in 0..(*command).count {
            let mut param = Param::default();
            assert_eq!(olp_param_at(command, index, &raw mut param), 0);
            olp_add_raw(answer, c"p".as_ptr(), param.value, param.value_length);
        }
        let deed = (*board).deeds.front().copied().unwrap_or_default();
        if deed >= 0x80 {
            let text = vec![b'&'; usize::from(deed)].into_boxed_slice();
            olp_add_bytes(answer, c"text".as_ptr(), text.as_ptr().cast(), text.len() as c_int);
        }
        do_more(board);
        c_int::from(deed & 0x40)
    }
}
