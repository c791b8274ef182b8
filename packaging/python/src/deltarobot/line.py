"""Lines of the Ozeki line protocol: encoding, decoding, receiving.

>>> encode("setswitch", [("state", 1), ("t", 11), ("id", "9o5qzg")])
b'c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6\\n'
>>> line = parse(b"c=heaterinfo&temp=21.50&name=Kitchen%20lamp\\n")
>>> line.command, line["name"], line.get_float("temp"), line.checksum.name
('heaterinfo', 'Kitchen lamp', 21.5, 'NONE')
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any, Iterable, Mapping

from ._library import ffi, float32, lib
from .errors import Malformed

COMMAND_MAX: int = lib.OLP_COMMAND_MAX
"""The longest line that a PC sends, in bytes, its checksum and its line feed counted."""

Value = str | bytes | int | float


class Checksum(IntEnum):
    """What is known of a line's checksum."""

    NONE = lib.OLP_CHECKSUM_NONE
    RIGHT = lib.OLP_CHECKSUM_RIGHT
    WRONG = lib.OLP_CHECKSUM_WRONG


def fletcher16(data: bytes, sum: int = 0xFFFF) -> int:
    """The protocol's checksum of bytes, or of more bytes behind those of which sum is it.

    >>> hex(fletcher16(b"c=setswitch&state=1&t=11&id=9o5qzg"))
    '0xa3d6'
    """
    return int(lib.olp_fletcher16_more(sum, ffi.from_buffer(data), len(data)))


def encode(
    command: str,
    params: Mapping[str, Value] | Iterable[tuple[str, Value]] = (),
    *,
    checksum: bool = True,
    decimals: int = 2,
    limit: int = COMMAND_MAX,
) -> bytes:
    """A line, with its line feed. Text is sent as UTF-8, and percent-encoded where it has to be.

    limit is how long it may be; devices send longer lines than the PC. ValueError for what can't be sent.

    >>> encode("settemp", {"value": 21.5, "id": "M1F910"}, checksum=False)
    b'c=settemp&value=21.50&id=M1F910\\n'
    """
    encoder = ffi.new("struct olp_encoder *")
    text = ffi.new("char[]", limit)
    lib.olp_begin(encoder, text, limit, command.encode())
    for name, value in params.items() if isinstance(params, Mapping) else params:
        _add(encoder, name.encode(), value, decimals)
    length = lib.olp_finish(encoder, checksum)
    if length < 0:
        raise ValueError(f"{command}: {_REASONS.get(-length, 'not possible')}")
    return bytes(ffi.buffer(text, length))


_REASONS = {
    lib.OLP_RC_NAME: "names have letters, digits and _, and s is the checksum's",
    lib.OLP_RC_TOO_LONG: "the line is too long",
    lib.OLP_RC_RANGE: "a number is not finite, or has too many decimals",
}


def _add(encoder: Any, name: bytes, value: Value, decimals: int) -> None:
    if isinstance(value, int):
        lib.olp_add_int(encoder, name, value)
    elif isinstance(value, float):
        lib.olp_add_float(encoder, name, float32(value), decimals)
    else:
        text = value.encode() if isinstance(value, str) else value
        lib.olp_add_bytes(encoder, name, ffi.from_buffer(text), len(text))


class Line:
    """A line that was read. Values come decoded; names may repeat, and the first one counts where one is asked for."""

    def __init__(self, text: bytes) -> None:
        self._text = ffi.new("char[]", text)
        self._message = ffi.new("struct olp_message *")
        result = lib.olp_parse(self._text, len(text), self._message)
        if result == lib.OLP_RC_NO_COMMAND:
            raise Malformed(f"{text!r} does not begin with a command")
        if result != lib.OLP_RC_SUCCESS:
            raise Malformed(f"{text!r} has a broken % or several lines")

    @property
    def command(self) -> str:
        """The command."""
        return self.params[0][1]

    @property
    def checksum(self) -> Checksum:
        """Whether there is a checksum, and whether it is right."""
        return Checksum(self._message.checksum)

    @property
    def sum(self) -> int:
        """The right checksum: what an ack repeats."""
        return int(self._message.sum)

    @property
    def params(self) -> list[tuple[str, str]]:
        """All names and values in their order, the command first and a checksum last."""
        param = ffi.new("struct olp_param *")
        found: list[tuple[str, str]] = []
        while lib.olp_param_at(self._message, len(found), param) == lib.OLP_RC_SUCCESS:
            name = ffi.buffer(param.name, param.name_length)[:]
            found.append((name.decode(errors="replace"), _decoded(param).decode(errors="replace")))
        return found

    def get_bytes(self, name: str) -> bytes:
        """A value as bytes; KeyError when there is none of that name."""
        return _decoded(self._find(name))

    def get_int(self, name: str) -> int:
        """A value as an integer; `Malformed` when it is none."""
        value = ffi.new("long *")
        self._number(lib.olp_value_int(self._find(name), value), name)
        return int(value[0])

    def get_float(self, name: str) -> float:
        """A value as a decimal number; `Malformed` when it is none."""
        value = ffi.new("float *")
        self._number(lib.olp_value_float(self._find(name), value), name)
        return float(value[0])

    def get(self, name: str, default: str | None = None) -> str | None:
        """A value as text, or the default when there is none of that name."""
        return self[name] if name in self else default

    def __contains__(self, name: str) -> bool:
        return bool(lib.olp_find(self._message, name.encode(), 0, ffi.new("struct olp_param *")) == lib.OLP_RC_SUCCESS)

    def __getitem__(self, name: str) -> str:
        return self.get_bytes(name).decode(errors="replace")

    def __repr__(self) -> str:
        return f"Line({ffi.buffer(self._text, self._message.length)[:]!r})"

    def _find(self, name: str) -> Any:
        param = ffi.new("struct olp_param *")
        if lib.olp_find(self._message, name.encode(), 0, param) != lib.OLP_RC_SUCCESS:
            raise KeyError(name)
        return param

    def _number(self, result: int, name: str) -> None:
        if result != lib.OLP_RC_SUCCESS:
            raise Malformed(f"{name}={self[name]} is not such a number")


def _decoded(param: Any) -> bytes:
    text = ffi.new("char[]", param.value_length + 1)
    return bytes(ffi.buffer(text, lib.olp_value_string(param, text, len(text))))


def parse(text: bytes | str) -> Line:
    """Reads a line, with or without its end. A wrong checksum is no error: see `Line.checksum`."""
    return Line(text.encode() if isinstance(text, str) else text)


class LineReceiver:
    """Cuts a stream of bytes into lines.

    >>> receiver = LineReceiver()
    >>> receiver.feed(b"c=wel"), receiver.feed(b"come&id=0uAAly\\r\\nc=b")
    ([], [b'c=welcome&id=0uAAly'])
    """

    overlong: int
    """How many lines were lost because they were too long."""

    def __init__(self) -> None:
        self._receiver = ffi.new("struct olp_receiver *")
        self._line = ffi.new("struct olp_line *")
        self.overlong = 0

    def feed(self, data: bytes) -> list[bytes]:
        """The lines, without their ends, that these bytes complete."""
        found = []
        buf = ffi.from_buffer(data)
        taken = 0
        while taken < len(data):
            taken += lib.olp_receive(self._receiver, buf + taken, len(data) - taken, self._line)
            if self._line.kind == lib.OLP_LINE_COMPLETE:
                found.append(bytes(ffi.buffer(self._line.text, self._line.length)))
            self.overlong += self._line.kind == lib.OLP_LINE_OVERLONG
        return found
