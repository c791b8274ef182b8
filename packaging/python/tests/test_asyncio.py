"""The twin of `Robot` for asyncio."""

import asyncio

import pytest

from conftest import Sim
from deltarobot import AsyncRobot, Cancelled, Disconnected, Refused, State


def test_home_move_and_status(sim: Sim) -> None:
    async def talk(port: str) -> None:
        async with AsyncRobot(port) as robot:
            with pytest.raises(Refused):
                await robot.move(1, 2, 3)
            await robot.home()
            move = asyncio.create_task(robot.move(10, 7.5, 12.5))
            async for status in robot.states(0.02):
                if status.position == (10, 7.5, 12.5):
                    break
            await move
            assert robot.health.frames > 5

    asyncio.run(talk(sim("--speed", "100").port))


def test_two_robots_at_once(sim: Sim) -> None:
    async def talk(*ports: str) -> None:
        async with AsyncRobot(ports[0]) as first, AsyncRobot(ports[1]) as second:
            await asyncio.gather(first.home(), second.home())
            await asyncio.gather(first.move(1, 1, 1), second.move(2, 2, 2))
            assert [(await robot.status()).position.a for robot in (first, second)] == [1, 2]

    asyncio.run(talk(sim("--speed", "100").port, sim("--speed", "100").port))


def test_cancel_and_cancelled_tasks(sim: Sim) -> None:
    async def talk(port: str) -> None:
        async with AsyncRobot(port) as robot:
            await robot.home()
            move = asyncio.create_task(robot.move(1000, 1000, 1000))
            while (await robot.status()).state != State.MOVING:
                pass
            await robot.cancel()
            with pytest.raises(Cancelled):
                await move
            # What a task waits for in vain is stopped too, before the task ends.
            with pytest.raises(asyncio.TimeoutError):
                await asyncio.wait_for(robot.move(1000, 1000, 1000), 0.5)
            status = await robot.status()
            assert status.state == State.IDLE and status.position.a < 1000

    asyncio.run(talk(sim("--speed", "20").port))


def test_a_robot_that_goes_away(sim: Sim) -> None:
    simulator = sim("--speed", "20")

    async def talk() -> None:
        async with AsyncRobot(simulator.port) as robot:
            home = asyncio.create_task(robot.home())
            await robot.status()
            simulator.end()
            with pytest.raises(Disconnected):
                await home
        with pytest.raises(Disconnected):
            async with AsyncRobot("/nowhere"):
                pass
        with pytest.raises(RuntimeError):
            await AsyncRobot("/nowhere").home()

    asyncio.run(talk())
