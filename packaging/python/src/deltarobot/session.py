"""The host's session without I/O: it is fed bytes and the time, and asked for events and for bytes to send.

>>> session = Session()
>>> session.home()
>>> session.poll(now_ms=0)
>>> session.output(now_ms=0).hex(" ")
'24 48 00 a6 3a'
>>> session.receive(bytes(Message.ack(Opcode.HOMING)), now_ms=20)
6
>>> session.poll(now_ms=20)
Event(kind=<EventKind.ACCEPTED: 5>, opcode=<Opcode.HOMING: 72>, outcome=None, status=None, message=None)
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from enum import IntEnum

from ._library import ffi, float32, lib
from .errors import Busy
from .messages import Layout, Message, Opcode, Status


class EventKind(IntEnum):
    """What has happened."""

    MESSAGE = lib.DP_HOST_MESSAGE
    STATUS = lib.DP_HOST_STATUS
    STATE = lib.DP_HOST_STATE
    ERROR = lib.DP_HOST_ERROR
    ACCEPTED = lib.DP_HOST_ACCEPTED
    ENDED = lib.DP_HOST_ENDED


class Outcome(IntEnum):
    """How a request has ended."""

    FINISHED = lib.DP_HOST_FINISHED
    REFUSED = lib.DP_HOST_REFUSED
    FAILED = lib.DP_HOST_FAILED
    CANCELLED = lib.DP_HOST_CANCELLED
    TIMED_OUT = lib.DP_HOST_TIMED_OUT


@dataclass(frozen=True)
class Settings:
    """Settings of a session, times in milliseconds; 0 stands for the default. `host.h` tells what each does."""

    ack_ms: int = 0
    guard_ms: int = 0
    settle_ms: int = 0
    poll_ms: int = 0
    silence_ms: int = 0
    operation_ms: int = 0
    gap_ms: int = 0
    tolerance: float = 0
    attempts: int = 0
    layout: Layout = Layout.AUTO
    messages: bool = False
    duplicates: bool = False


@dataclass(frozen=True)
class Health:
    """Statistics of a session since it began."""

    frames: int
    malformed: int
    strays: int
    garbage_bytes: int
    checksum_failures: int
    timeouts: int
    retransmissions: int
    rtt_count: int
    rtt_last: int
    rtt_min: int
    rtt_max: int
    rtt_sum: int


@dataclass(frozen=True)
class Event:
    """Something that has happened: opcode and outcome of a request, a status report, or a message."""

    kind: EventKind
    opcode: Opcode | None = None
    outcome: Outcome | None = None
    status: Status | None = None
    message: Message | None = None


class Session:
    """The host's end of the link: sends requests, retransmits them, reports exactly once how each has ended.

    After a request and after `receive`, and when `next_deadline` says so: `poll` until it is None, then send what
    `output` returns. Times are milliseconds of any clock that doesn't go back.
    """

    def __init__(self, settings: Settings = Settings()) -> None:
        self._host = ffi.new("struct dp_host *")
        self._event = ffi.new("struct dp_host_event *")
        lib.dp_host_init(self._host, ffi.new("struct dp_host_settings *", asdict(settings)))

    def home(self) -> None:
        """Requests homing; `Busy` while another motion is going on."""
        self._request(lib.dp_host_home(self._host), "motion")

    def move(self, a: float, b: float, c: float) -> None:
        """Requests a move to a position; `Busy` while another motion is going on, ValueError for no such position."""
        target = [float32(a), float32(b), float32(c)]
        self._request(lib.dp_host_move(self._host, ffi.new("struct protocol_msg_position *", target)), "motion")

    def cancel(self) -> None:
        """Requests that the motion be cancelled. Both requests end."""
        self._request(lib.dp_host_cancel(self._host), "request to cancel")

    def status(self) -> None:
        """Requests a status report."""
        self._request(lib.dp_host_status(self._host), "request for the status")

    @staticmethod
    def _request(result: int, what: str) -> None:
        if result == lib.DP_RC_BUSY:
            raise Busy(f"a {what} is going on")
        if result != lib.DP_RC_SUCCESS:
            raise ValueError("a position consists of finite numbers")

    @property
    def busy(self) -> bool:
        """Whether a motion is going on."""
        return bool(lib.dp_host_busy(self._host))

    @property
    def health(self) -> Health:
        """The statistics so far."""
        health = ffi.new("struct dp_host_health *")
        lib.dp_host_get_health(self._host, health)
        return Health(*(getattr(health, field.name) for field in fields(Health)))

    def receive(self, data: bytes, now_ms: int) -> int:
        """Takes received bytes: returns how many. Give it the rest when all events were fetched."""
        return int(lib.dp_host_receive(self._host, ffi.from_buffer(data), len(data), _clock(now_ms)))

    def poll(self, now_ms: int) -> Event | None:
        """The next event, or None."""
        event = self._event
        if lib.dp_host_poll(self._host, _clock(now_ms), event) != lib.DP_RC_SUCCESS:
            return None
        kind = EventKind(event.kind)
        if kind in (EventKind.ACCEPTED, EventKind.ENDED):
            outcome = Outcome(event.outcome) if event.outcome else None
            return Event(kind, opcode=Opcode(event.opcode), outcome=outcome)
        if kind in (EventKind.STATUS, EventKind.STATE):
            return Event(kind, status=Status._of(event.report))
        return Event(kind, message=Message._of(event.msg) if kind == EventKind.MESSAGE else None)

    def output(self, now_ms: int) -> bytes:
        """What is to be sent now."""
        out = ffi.new("char[]", lib.DP_HOST_OUTPUT_MAX)
        return bytes(ffi.buffer(out, lib.dp_host_output(self._host, out, len(out), _clock(now_ms))))

    def next_deadline(self, now_ms: int) -> int | None:
        """For how many milliseconds `poll` has nothing to do if nothing is received or requested; None: for ever."""
        wait = int(lib.dp_host_next_deadline(self._host, _clock(now_ms)))
        return None if wait < 0 else wait


def _clock(now_ms: int) -> int:
    return now_ms & 0xFFFFFFFF
