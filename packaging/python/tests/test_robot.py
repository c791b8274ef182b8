"""Robots at a port: simulated ones on pseudo-terminals, as real ones are met."""

import math
import signal
import socket
import subprocess
import sys
import threading

import pytest
import serial

from conftest import Sim
from deltarobot import Busy, Cancelled, Disconnected, Failed, Refused, Robot, Settings, State, TimedOut


def test_home_move_and_status(sim: Sim) -> None:
    with Robot(sim("--speed", "500").port) as robot:
        assert not robot.status().position.known
        robot.home()
        robot.move(10, 7.5, 12.5)
        status = robot.status()
        assert status.state == State.IDLE
        assert all(math.isclose(is_at, target) for is_at, target in zip(status.position, (10, 7.5, 12.5)))
        assert not any(status.stops)
        assert robot.health.frames > 5 and robot.health.garbage_bytes == 0


def test_a_move_before_homing_is_refused_and_the_robot_goes_on(sim: Sim) -> None:
    with Robot(sim("--speed", "500").port) as robot:
        with pytest.raises(Refused, match="MOVE! refused"):
            robot.move(1, 2, 3)
        robot.home()


def test_a_move_that_ends_at_a_stop_has_failed(sim: Sim) -> None:
    with Robot(sim("--speed", "500").port) as robot:
        robot.home()
        with pytest.raises(Failed):
            robot.move(-5, 5, 5)
        assert robot.status().stops.a


def test_cancel_from_another_thread(sim: Sim) -> None:
    with Robot(sim("--speed", "20").port) as robot:
        robot.home()
        move = robot.start_move(1000, 1000, 1000)
        with pytest.raises(Busy):
            robot.start_home()
        while robot.status().state != State.MOVING:
            pass
        canceller = threading.Thread(target=robot.cancel)
        canceller.start()
        with pytest.raises(Cancelled):
            move.result()
        canceller.join()
        assert robot.status().state == State.IDLE


def test_states_show_a_move(sim: Sim) -> None:
    with Robot(sim("--speed", "50").port) as robot:
        robot.home()
        shown = list(robot.states(0.05, until=robot.start_move(20, 20, 20)))
        assert {status.state for status in shown} <= {State.MOVING, State.IDLE}
        heights = [status.position.a for status in shown]
        assert heights == sorted(heights) and heights[-1] == 20


def test_leaving_cancels_the_motion(sim: Sim) -> None:
    simulator = sim("--speed", "20")
    with pytest.raises(KeyError), Robot(simulator.port) as robot:
        robot.home()
        robot.start_move(1000, 1000, 1000)
        raise KeyError
    with Robot(simulator.port) as robot:
        status = robot.status()
        assert status.state == State.IDLE and status.position.a < 1000


def test_a_robot_that_goes_away(sim: Sim) -> None:
    simulator = sim("--speed", "20")
    with Robot(simulator.port) as robot:
        robot.home()
        move = robot.start_move(1000, 1000, 1000)
        simulator.end()
        with pytest.raises(Disconnected) as caught:
            move.result()
        assert caught.value.__cause__ is not None
        with pytest.raises(Disconnected):
            robot.status()


def test_a_robot_that_does_not_answer(sim: Sim) -> None:
    settings = Settings(ack_ms=20, guard_ms=40, attempts=2)
    with Robot(sim("--no-ack").port, settings=settings) as robot, pytest.raises(TimedOut):
        robot.home()


def test_a_port_that_is_not_there_or_in_use(sim: Sim) -> None:
    with pytest.raises(Disconnected, match="nowhere"):
        Robot("/nowhere")
    with pytest.raises(Disconnected):
        Robot("nonsense://")
    port = sim().port
    with Robot(port), pytest.raises(Disconnected):
        Robot(port)


def test_closing_ends_what_waits(sim: Sim) -> None:
    robot = Robot(sim("--no-ack").port, settings=Settings(attempts=255))
    waiting = robot._driver.status()
    robot.close()
    assert waiting.done()
    with pytest.raises(Disconnected, match="closed"):
        robot.status()
    robot.close()


def test_an_open_pyserial_object_stays_open(sim: Sim) -> None:
    with serial.Serial(sim().port) as port:
        with Robot(port) as robot:
            robot.status()
        assert port.is_open
        with Robot(port) as robot:
            robot.status()


def test_a_network_port(sim: Sim) -> None:
    """As converters offer them, by pyserial's URL."""
    device = serial.Serial(sim("--speed", "500").port, timeout=0.01)
    server = socket.create_server(("127.0.0.1", 0))
    ends = threading.Event()

    def pass_on() -> None:
        connection, _ = server.accept()
        with connection:
            connection.settimeout(0.01)
            while not ends.is_set():
                try:
                    device.write(connection.recv(64))
                except socket.timeout:
                    pass
                connection.sendall(device.read(device.in_waiting))

    converter = threading.Thread(target=pass_on)
    converter.start()
    try:
        with Robot(f"socket://127.0.0.1:{server.getsockname()[1]}") as robot:
            robot.home()
            robot.move(1, 2, 3)
    finally:
        ends.set()
        converter.join()
        server.close()
        device.close()


def test_ctrl_c_cancels_the_motion(sim: Sim) -> None:
    port = sim("--speed", "20").port
    program = f"""
from deltarobot import Robot

with Robot({port!r}) as robot:
    robot.home()
    print("homed", flush=True)
    robot.move(1000, 1000, 1000)
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        assert running.stdout is not None and running.stdout.readline().strip() == b"homed"
        running.send_signal(signal.SIGINT)
        assert b"KeyboardInterrupt" in running.communicate()[1]
    with Robot(port) as robot:
        status = robot.status()
        assert status.state == State.IDLE and status.position.a < 1000
