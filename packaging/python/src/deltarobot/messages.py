"""The messages of the deltarobot format: encoding, decoding, receiving.

>>> bytes(Message(Opcode.STATUS)).hex(" ")
'24 53 00 b1 3a'
>>> for message in Receiver().feed(bytes(Message.move(10, 7.5, 12.5)) + b"noise" + bytes(Message.ack(Opcode.MOVE))):
...     print(message)
MOVE!:  DA=10  DB=7.5  DC=12.5
ACK: (MOVE!)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NamedTuple

from ._library import ffi, float32, lib
from .errors import Malformed

DATA_MAX_SIZE: int = lib.DP_DATA_MAX_SIZE
"""The longest payload of a message."""


class Opcode(IntEnum):
    """What a message is. Those that end with REPLY come from the controller."""

    ACK = ord("A")
    NACK = ord("N")
    HOMING = ord("H")
    STATUS = ord("S")
    MOVE = ord("M")
    CANCEL = ord("C")
    HOMING_REPLY = ord("h")
    STATUS_REPLY = ord("s")
    MOVE_REPLY = ord("m")
    GENERAL_ERROR = ord("e")


class State(IntEnum):
    """What the platform does."""

    IDLE = lib.DP_STATUS_IDLE
    HOMING = lib.DP_STATUS_HOMING
    MOVING = lib.DP_STATUS_MOVING
    ERROR = lib.DP_STATUS_ERROR


class Layout(IntEnum):
    """How status reports are laid out: AUTO finds it out, FIRMWARE has the numbers first."""

    AUTO = lib.DP_LAYOUT_AUTO
    SPEC = lib.DP_LAYOUT_SPEC
    FIRMWARE = lib.DP_LAYOUT_FIRMWARE


class Position(NamedTuple):
    """The displacements of the three arms, in the firmware's unit; a NaN where one is unknown."""

    a: float
    b: float
    c: float

    @property
    def known(self) -> bool:
        """Whether all three are numbers.

        >>> Position(1, 2, float("nan")).known
        False
        """
        return not any(map(math.isnan, self))


class Stops(NamedTuple):
    """Which end stops are pressed."""

    a: bool
    b: bool
    c: bool


@dataclass(frozen=True)
class Status:
    """A status report."""

    state: State
    position: Position
    stops: Stops = Stops(False, False, False)

    @classmethod
    def _of(cls, report: Any) -> Status:
        stops = (bool(report.STAT & 1 << bit) for bit in _STOP_BITS)
        state = State(report.STAT & lib.DP_BIT_STAT_STATUS_BITS)
        return cls(state, Position(report.DA, report.DB, report.DC), Stops(*stops))


_STOP_BITS = (2, 3, 4)


@dataclass(frozen=True)
class Message:
    """A message: `bytes(message)` is its frame, `str(message)` a line for people."""

    opcode: int
    payload: bytes = b""

    def __post_init__(self) -> None:
        if not 0 <= self.opcode <= 255:
            raise ValueError(f"opcode {self.opcode} is not a byte")
        if len(self.payload) > DATA_MAX_SIZE:
            raise ValueError(f"a payload has at most {DATA_MAX_SIZE} bytes, not {len(self.payload)}")

    @classmethod
    def ack(cls, answered: int) -> Message:
        """The acknowledgement of a request."""
        return cls(Opcode.ACK, bytes([answered]))

    @classmethod
    def nack(cls, answered: int) -> Message:
        """The refusal of a request."""
        return cls(Opcode.NACK, bytes([answered]))

    @classmethod
    def move(cls, a: float, b: float, c: float) -> Message:
        """The request to move to a position."""
        msg = ffi.new("struct protocol_msg *")
        target = ffi.new("struct protocol_msg_position *", [float32(a), float32(b), float32(c)])
        if lib.dp_build_move(msg, target) != lib.DP_RC_SUCCESS:
            raise ValueError(f"the library was built for payloads of {DATA_MAX_SIZE} bytes: too few for a position")
        return cls._of(msg)

    @classmethod
    def status_reply(cls, status: Status, layout: Layout = Layout.FIRMWARE) -> Message:
        """A status report.

        >>> report = Message.status_reply(Status(State.IDLE, Position(1, 2, 3), Stops(True, False, False)))
        >>> report.status().stops.a
        True
        """
        stat = status.state | sum(bool(stop) << bit for stop, bit in zip(status.stops, _STOP_BITS))
        msg = ffi.new("struct protocol_msg *")
        report = ffi.new("struct protocol_msg_status_report *", [*map(float32, status.position), stat])
        if lib.dp_build_status_report(msg, report, layout) != lib.DP_RC_SUCCESS:
            raise ValueError(f"the library was built for payloads of {DATA_MAX_SIZE} bytes: too few for a report")
        return cls._of(msg)

    @classmethod
    def _of(cls, msg: Any) -> Message:
        return cls(msg.opcode, bytes(ffi.buffer(msg.data, msg.data_s)))

    def _msg(self) -> Any:
        return ffi.new("struct protocol_msg *", [self.opcode, len(self.payload), self.payload, 1])

    def __bytes__(self) -> bytes:
        sent = bytearray()
        handle = ffi.new_handle(sent)
        lib.dp_send(self._msg(), _append, handle)
        return bytes(sent)

    def __str__(self) -> str:
        text = ffi.new("char[]", lib.DP_MSG_TEXT_MAX)
        lib.dp_msg_format(self._msg(), text, lib.DP_MSG_TEXT_MAX)
        return str(ffi.string(text), "ascii")

    @property
    def valid(self) -> bool:
        """Whether it is one of the specification's: its opcode is known, and its payload as long as that asks for."""
        return bool(lib.dp_msg_check(self._msg()) == lib.DP_RC_SUCCESS)

    def answered(self) -> int:
        """Which opcode an ack or a nack answers; of other messages, a `Malformed`."""
        answered = ffi.new("unsigned char *")
        self._read(lib.dp_read_answer(self._msg(), answered), "an ack or a nack")
        return int(answered[0])

    def target(self) -> Position:
        """Where to the move that is requested leads; of other messages, a `Malformed`."""
        target = ffi.new("struct protocol_msg_position *")
        self._read(lib.dp_read_move(self._msg(), target), "a request to move")
        return Position(target.DA, target.DB, target.DC)

    def status(self, layout: Layout = Layout.AUTO) -> Status:
        """What a status report says; of other messages, a `Malformed`."""
        report = ffi.new("struct protocol_msg_status_report *")
        self._read(lib.dp_read_status_report(self._msg(), layout, report), "a status report")
        return Status._of(report)

    def _read(self, result: int, what: str) -> None:
        if result != lib.DP_RC_SUCCESS:
            raise Malformed(f"{self!r} is not {what}")


@ffi.callback("send_func_t")  # type: ignore[untyped-decorator,unused-ignore]
def _append(buf: Any, size: int, usr: Any) -> int:
    ffi.from_handle(usr).extend(ffi.buffer(buf, size))
    return 0


class Receiver:
    """Finds the messages in a stream of bytes, by the drop-in: every intact frame, however they come."""

    def __init__(self) -> None:
        self._ring = ffi.new("struct protocol_data *")
        self._msg = ffi.new("struct protocol_msg *")

    def feed(self, data: bytes | bytearray | memoryview) -> list[Message]:
        """The messages that these bytes complete."""
        found = []
        view = memoryview(data).cast("B")
        while view:
            # As much as there is room for: then nothing is lost.
            part = view[: lib.DP_BUFSIZE - self._ring.m_sz]
            view = view[len(part) :]
            lib.dp_process(self._ring, ffi.from_buffer(bytes(part)), len(part))
            found += self._fetch(lib.dp_recv)
        return found

    def idle(self) -> list[Message]:
        r"""What stands behind an incomplete message, which is given up: for a line that has been quiet for long enough.

        >>> receiver = Receiver()
        >>> receiver.feed(b"$S\x05" + bytes(Message(Opcode.STATUS)))
        []
        >>> [str(message) for message in receiver.idle()]
        ['STATUS?']
        """
        return self._fetch(lib.dp_recv_idle)

    def _fetch(self, receive: Any) -> list[Message]:
        found = []
        while receive(self._ring, self._msg) == lib.DP_RC_SUCCESS:
            found.append(Message._of(self._msg))
        return found
