"""Messages of the three protocols, against recordings, samples and their own inverses."""

import random
from pathlib import Path

import numpy
import pytest

from deltarobot import Layout, Malformed, Message, Opcode, Position, Receiver, Session, State, Status, Stops
from deltarobot import gx, kinematics, line

C_TESTS = Path(__file__).resolve().parents[3] / "c_tests"
TRACES = C_TESTS / "deltarobot" / "traces"


def unhex(text: str) -> bytes:
    return b"" if text == "-" else bytes.fromhex(text)


@pytest.mark.parametrize("kind", ["clean", "tricky"])
def test_the_original_received_these_messages(kind: str) -> None:
    count = 0
    for trace in (TRACES / f"{kind}.128-32.txt").read_text().split("\nT ")[1:]:
        records = [record.split() for record in trace.splitlines()[1:]]
        receiver = Receiver()
        received = [message for kind, *rest in records if kind == "P" for message in receiver.feed(unhex(rest[0]))]
        recorded = [
            Message(int(opcode, 16), unhex(data))
            for kind, rc, *rest in records
            if kind == "R" and rc == "0"
            for _, _, opcode, _, data, _ in [rest]
        ]
        # The original was not asked again at each trace's end.
        assert received[: len(recorded)] == recorded
        count += len(recorded)
    assert count > 1000


def test_the_original_sent_these_bytes() -> None:
    records = [line.split() for line in (TRACES / "send.32.txt").read_text().splitlines() if line.startswith("S ")]
    for _, opcode, _, data, _, _, wire in records:
        assert bytes(Message(int(opcode, 16), unhex(data))) == unhex(wire)
    assert len(records) > 10


def test_any_pieces_give_the_same_messages() -> None:
    dice = random.Random(1)
    messages = [Message(dice.choice(list(Opcode)), dice.randbytes(dice.randrange(33))) for _ in range(500)]
    stream = b"".join(map(bytes, messages))
    assert Receiver().feed(stream) == messages
    assert Receiver().feed(memoryview(bytearray(stream))) == messages
    receiver, received = Receiver(), []
    while stream:
        size = dice.randrange(1, 200)
        received += receiver.feed(stream[:size])
        stream = stream[size:]
    assert received == messages


def test_messages_say_what_they_are() -> None:
    assert Message.move(1, 2, -3.5).target() == (1, 2, -3.5)
    assert Message.nack(Opcode.MOVE).answered() == Opcode.MOVE
    status = Status(State.MOVING, Position(1, 2, 3), Stops(False, True, False))
    for layout, size in ((Layout.SPEC, 13), (Layout.FIRMWARE, 16)):
        message = Message.status_reply(status, layout)
        assert message.status() == message.status(layout) == status and len(message.payload) == size
    assert Message(Opcode.HOMING).valid and not Message(Opcode.HOMING, b"x").valid and not Message(0).valid
    for wrong in (Message.answered, Message.target, Message.status):
        with pytest.raises(Malformed):
            wrong(Message(Opcode.HOMING))


def test_messages_that_there_are_not() -> None:
    for arguments in ((256, b""), (-1, b""), (0, bytes(33))):
        with pytest.raises(ValueError):
            Message(*arguments)
    with pytest.raises(ValueError):
        Message.move(1e39, 0, 0)
    for coordinate in (float("nan"), float("inf"), 1e39):
        with pytest.raises(ValueError):
            Session().move(coordinate, 0, 0)


def test_lines_of_a_recorded_conversation() -> None:
    lines = [text[4:].encode() for text in (C_TESTS / "cli" / "sample.txt").read_text().splitlines()]
    receiver = line.LineReceiver()
    assert receiver.feed(b"\n".join(lines) + b"\n") == lines
    for text in lines:
        read = line.parse(text)
        assert read.params[0] == ("c", read.command)
        again = line.encode(read.command, read.params[1:], checksum=False, limit=255)
        assert line.parse(again).params == read.params
        assert again.rstrip() == text or b"%" in text or b"!" in text or b" " in text, text
    assert len(lines) > 20


def test_values_of_lines() -> None:
    values: dict[str, line.Value] = {"a": -5, "b": 1.5, "c2": b"\0&\xff", "d": "Küche 1"}
    text = line.encode("set", values, decimals=3)
    read = line.parse(text)
    assert read.checksum == line.Checksum.RIGHT
    numbers = read.get_int("a"), read.get_float("b")
    assert (*numbers, read.get_bytes("c2"), read["d"]) == (-5, 1.5, b"\0&\xff", "Küche 1")
    assert "a" in read and "e" not in read and read.get("e", "none") == "none"
    assert line.parse(text.replace(b"-5", b"-6")).checksum == line.Checksum.WRONG
    with pytest.raises(KeyError):
        read.get_int("e")
    with pytest.raises(Malformed):
        read.get_int("d")


def test_lines_that_there_are_not() -> None:
    for wrong in (b"x=1", b"", b"c=a&b=%", b"c=a\nc=b"):
        with pytest.raises(Malformed):
            line.parse(wrong)
    for command in ("", "a b"):
        with pytest.raises(ValueError):
            line.encode(command)
    unsendable: list[tuple[str, line.Value]] = [("s", 1), ("x", "x" * 64), ("x", float("nan")), ("", 1)]
    for param in unsendable:
        with pytest.raises(ValueError):
            line.encode("a", [param])
    with pytest.raises((OverflowError, ValueError)):
        line.encode("a", {"x": 1 << 70})
    receiver = line.LineReceiver()
    assert receiver.feed(b"x" * 1000 + b"\nc=a\n") == [b"c=a"] and receiver.overlong == 1


def test_gx_commands_and_notices_come_back() -> None:
    dice = random.Random(2)
    for _ in range(300):
        form = dice.choice(list(gx.Format))
        number = dice.choice([None, gx.Number(dice.randrange(16384), form)])
        axes = {axis: dice.randrange(-(2**27), 2**27) for axis in gx.AXES if dice.random() < 0.5}
        vector = gx.Vector(**axes, velocity=dice.randrange(16384))
        (item,) = gx.CommandReceiver().feed(gx.move(vector, number, form))
        assert (item.kind, item.format, item.number, item.vector) == (gx.Kind.MOVE, form, number, vector)
        (item,) = gx.CommandReceiver().feed(gx.shortest(vector, gx.Vector(), number))
        assert (item.number, item.vector) == (number, vector)
    commands = gx.step(gx.Vector(x=-63, c=63)) + gx.reporting(100) + gx.control(gx.Control.HOLD)
    step, reporting, control = gx.CommandReceiver().feed(commands)
    assert step.vector == gx.Vector(x=-63, c=63) and reporting.period == 100 and control.code == gx.Control.HOLD
    receiver = gx.NoticeReceiver()
    assert receiver.feed(gx.completed(gx.Number(5))) == []
    completed = receiver.idle()
    assert completed is not None and (completed.kind, completed.number) == (gx.Kind.COMPLETED, gx.Number(5))
    check = gx.check(gx.Vector(x=5), 7)
    notices = gx.refused(9, gx.Number(6)) + gx.position(gx.Vector(x=-1)) + gx.confirmed(gx.Number(7), check)
    refused, position, confirmed, status = receiver.feed(notices + gx.status(16, True))
    assert (refused.code, position.vector.x, confirmed.code) == (9, -1, check)
    assert (status.period, status.code) == (16, 1)


def test_a_gx_path_is_followed() -> None:
    dice = random.Random(3)
    path = [(dice.randrange(-200, 200), dice.randrange(-200, 200)) for _ in range(200)]
    contour, place, receiver = gx.Contour("xz"), gx.Vector(), gx.CommandReceiver()
    for point in path:
        (item,) = receiver.feed(contour.segment(point, velocity=100))
        place = gx.follow(place, item)
        assert (place.x, place.z) == point


def test_gx_values_that_there_are_not() -> None:
    for wrong in (gx.Vector(x=2**27), gx.Vector(x=2**40), gx.Vector(velocity=16384), gx.Vector()):
        with pytest.raises(ValueError):
            gx.move(wrong)
    for number in (-1, 16384):
        with pytest.raises(ValueError):
            gx.completed(gx.Number(number))
        with pytest.raises(ValueError):
            gx.check(gx.Vector(x=1), number)
    with pytest.raises(ValueError):
        gx.Contour("")
    with pytest.raises(ValueError):
        gx.Contour("xy").segment((1, 2, 3))


def test_noise_does_no_harm() -> None:
    noise = random.Random(4).randbytes(20000)
    session = Session()
    for receiver in (Receiver(), line.LineReceiver(), gx.CommandReceiver(), gx.NoticeReceiver()):
        receiver.feed(noise)
    while noise:
        noise = noise[session.receive(noise, 1) :]
        while session.poll(1):
            pass


def test_kinematics_of_arrays() -> None:
    robot = kinematics.Configuration((0.12, 0, 0.10), (0.38, 0, 0.25), (0.12, 0, 0.40), 0.15, 0.08)
    poses = numpy.random.default_rng(5).uniform((0.2, 0.35, 0.2), (0.3, 0.5, 0.3), (20, 10, 3))
    lengths = kinematics.inverse(robot, poses)
    assert lengths.shape == poses.shape
    assert numpy.allclose(kinematics.forward(robot, lengths), poses, atol=1e-3)
    assert numpy.isnan(kinematics.forward(robot, [[9.0, 1.0, 1.0], [numpy.nan, 1.0, 1.0]])).all()
    assert kinematics.inverse(robot, numpy.empty((0, 3))).shape == (0, 3)
    for wrong in (1, [1, 2], numpy.zeros((3, 2))):
        with pytest.raises(ValueError):
            kinematics.inverse(robot, wrong)
    with pytest.raises(ValueError):
        kinematics.Configuration((0, 0, 0), (1, 0, 0), (0, 0, 0), 1, 1)
