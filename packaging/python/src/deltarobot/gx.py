"""Commands and notices of the GX binary vector protocol: encoding, decoding, receiving.

>>> move(Vector(x=1000, y=400, velocity=300), format=Format.ASCII)
b'V300x1000y400\\n'
>>> CommandReceiver().feed(move(Vector(x=-1), number=Number(7)))[0].vector
Vector(x=-1, y=None, z=None, a=None, b=None, c=None, velocity=None)
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any, Callable, Sequence

from ._library import ffi, lib

AXES = "xyzabc"


class Format(IntEnum):
    """How a command or notice is written."""

    BINARY = lib.GX_BINARY
    ASCII = lib.GX_ASCII


class Kind(IntEnum):
    """What a command or notice is."""

    MOVE = lib.GX_MOVE
    STEP = lib.GX_STEP
    REPORTING = lib.GX_REPORTING
    MALFORMED = lib.GX_MALFORMED
    COMPLETED = lib.GX_COMPLETED
    REFUSED = lib.GX_REFUSED
    POSITION = lib.GX_POSITION
    CONFIRMED = lib.GX_CONFIRMED
    CONTROL = lib.GX_CONTROL
    STATUS = lib.GX_STATUS


class Control(IntEnum):
    """What a host asks for past the queue."""

    QUERY = lib.GX_CONTROL_QUERY
    HOLD = lib.GX_CONTROL_HOLD
    RESUME = lib.GX_CONTROL_RESUME
    STOP = lib.GX_CONTROL_STOP


@dataclass(frozen=True)
class Number:
    """The number of a command, 0 to 16383."""

    value: int
    format: Format = Format.BINARY


@dataclass(frozen=True)
class Vector:
    """Positions or deltas in steps, and a velocity in steps per second; None: not named."""

    x: int | None = None
    y: int | None = None
    z: int | None = None
    a: int | None = None
    b: int | None = None
    c: int | None = None
    velocity: int | None = None

    @classmethod
    def _of(cls, vector: Any) -> Vector:
        values = [*vector.axes, vector.velocity]
        return cls(*(value if vector.mask & 1 << bit else None for bit, value in enumerate(values)))

    def _vector(self) -> Any:
        values = [getattr(self, field.name) for field in fields(self)]
        mask = sum(1 << bit for bit, value in enumerate(values) if value is not None)
        *axes, velocity = [value or 0 for value in values]
        try:
            return ffi.new("struct gx_vector *", [velocity, mask, axes])
        except OverflowError as error:
            raise ValueError(f"{self}: {error}") from error


@dataclass(frozen=True)
class Item:
    """A command or a notice. What number, code, period and vector mean depends on the kind: `gx.h` tells."""

    kind: Kind
    format: Format
    number: Number | None = None
    code: int = 0
    period: int = 0
    vector: Vector = Vector()

    @classmethod
    def _of(cls, item: Any) -> Item:
        number = Number(item.number.value, Format(item.number.format)) if item.number.format else None
        form = Format(item.format or Format.BINARY)
        return cls(Kind(item.kind), form, number, item.code, item.period, Vector._of(item.vector))

    def _item(self) -> Any:
        number = _number(self.number)[0] if self.number else [0, 0]
        return ffi.new(
            "struct gx_item *", [self.kind, number, self.format, self.code, self.period, self.vector._vector()[0]]
        )


def _number(number: Number | None) -> Any:
    if number is None:
        return ffi.NULL
    if not 0 <= number.value <= lib.GX_NUMBER_MAX:
        raise ValueError(f"a number is 0 to {lib.GX_NUMBER_MAX}, not {number.value}")
    return ffi.new("struct gx_number *", [number.value, number.format])


def _written(write: Callable[..., int], *arguments: Any) -> bytes:
    out = ffi.new("char[]", lib.GX_ENCODED_MAX)
    length = write(*arguments, out, len(out))
    if length < 0:
        raise ValueError("a value does not fit, or none is named" if -length == lib.GX_RC_RANGE else "not possible")
    return bytes(ffi.buffer(out, length))


def move(target: Vector, number: Number | None = None, format: Format = Format.BINARY) -> bytes:
    """The command to go to positions; without axes it sets the velocity of those to come."""
    return _written(lib.gx_write_move, format, _number(number), target._vector())


def step(deltas: Vector, number: Number | None = None) -> bytes:
    """The command to go on by deltas of -63 to 63 steps.

    >>> step(Vector(x=10, y=-10)).hex()
    '2a838af6'
    """
    return _written(lib.gx_write_step, _number(number), deltas._vector())


def shortest(target: Vector, start: Vector, number: Number | None = None) -> bytes:
    """The shortest command that leads from a position to a target."""
    return _written(lib.gx_write_shortest, _number(number), target._vector(), start._vector())


def reporting(period_ms: int, number: Number | None = None, format: Format = Format.BINARY) -> bytes:
    """The command to report the position so often; 0: never."""
    return _written(lib.gx_write_reporting, format, _number(number), period_ms)


def control(asked: Control, number: Number | None = None, format: Format = Format.BINARY) -> bytes:
    """What a host asks for past the queue."""
    return _written(lib.gx_write_control, format, _number(number), asked)


def completed(number: Number) -> bytes:
    """The notice that a command was carried out."""
    return _written(lib.gx_write_completed, _number(number))


def refused(code: int, number: Number | None = None, format: Format = Format.BINARY) -> bytes:
    """The notice that a command was not carried out."""
    return _written(lib.gx_write_refused, format, _number(number), code)


def position(vector: Vector, format: Format = Format.BINARY) -> bytes:
    """A position report."""
    return _written(lib.gx_write_position, format, vector._vector())


def confirmed(number: Number, check: int) -> bytes:
    """The notice that a move of a session was carried out."""
    return _written(lib.gx_write_confirmed, _number(number), check)


def status(free: int, held: bool = False, format: Format = Format.BINARY) -> bytes:
    """The status of a motion side: so many more moves fit into its queue."""
    return _written(lib.gx_write_status, format, free, held)


def check(target: Vector, number: int) -> int:
    """The check of a move: what its confirmation in a session holds."""
    result = int(lib.gx_check(target._vector(), number))
    if result < 0:
        raise ValueError(f"a number is 0 to {lib.GX_NUMBER_MAX}, not {number}")
    return result


def follow(start: Vector, item: Item) -> Vector:
    """Where a command or notice leads from a position.

    >>> follow(Vector(x=5, y=5), CommandReceiver().feed(step(Vector(x=10)))[0]).x
    15
    """
    vector = start._vector()
    if lib.gx_follow(vector, item._item()) != lib.GX_RC_SUCCESS:
        raise ValueError(f"{item} leads out of the positions, or starts where the position is not known")
    return Vector._of(vector)


class _Receiver:
    def __init__(self, receiver: Any, receive: Callable[..., int], idle: Callable[..., int]) -> None:
        self._receiver = receiver
        self._receive = receive
        self._idle = idle
        self._item = ffi.new("struct gx_item *")

    def feed(self, data: bytes) -> list[Item]:
        """What these bytes complete, the malformed included."""
        found = []
        buf = ffi.from_buffer(data)
        taken = 0
        while taken < len(data):
            taken += self._receive(self._receiver, buf + taken, len(data) - taken, self._item)
            if self._item.kind:
                found.append(Item._of(self._item))
        return found

    def idle(self) -> Item | None:
        """What is complete, or given up, now that the line has been quiet for longer than a message takes."""
        self._idle(self._receiver, self._item)
        return Item._of(self._item) if self._item.kind else None


class CommandReceiver(_Receiver):
    """Receives commands: the motion side's."""

    def __init__(self) -> None:
        super().__init__(ffi.new("struct gx_commands *"), lib.gx_commands_receive, lib.gx_commands_idle)


class NoticeReceiver(_Receiver):
    """Receives notices: the host's. A packed completion is reported when the next byte has come, or by `idle`."""

    def __init__(self) -> None:
        super().__init__(ffi.new("struct gx_notices *"), lib.gx_notices_receive, lib.gx_notices_idle)


class Contour:
    """Writes a path as the shortest stream of commands.

    >>> contour = Contour("xy", Vector(x=0, y=0))
    >>> [contour.segment(point).hex() for point in [(500, 0), (510, 5)]]
    ['2181f4838080', '2a838a85']
    """

    def __init__(self, axes: str = AXES, start: Vector | None = None) -> None:
        self._axes = [AXES.index(axis) for axis in axes]
        self._contour = ffi.new("struct gx_contour *")
        if lib.gx_contour_init(self._contour, sum(1 << axis for axis in self._axes)) != lib.GX_RC_SUCCESS:
            raise ValueError("a path has an axis at least, and each of them once")
        self.start(start)

    def start(self, start: Vector | None) -> None:
        """Sets where the machine is; None: not known, as after an error notice."""
        lib.gx_contour_start(self._contour, start._vector() if start else ffi.NULL)

    def segment(
        self, point: Sequence[int], velocity: int | None = None, number: Number | None = None
    ) -> bytes:
        """The shortest command to the next point: a value for each axis of the path, in the order they were named."""
        place = [0] * len(AXES)
        for axis, value in zip(self._axes, point, strict=True):
            place[axis] = value
        velocity = -1 if velocity is None else velocity
        return _written(
            lib.gx_contour_segment, self._contour, _number(number), ffi.new("int32_t[]", place), velocity
        )
