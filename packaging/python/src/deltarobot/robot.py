"""The robot at a port, for programs that wait for it: `Robot`, and its twin for asyncio, `AsyncRobot`."""

from __future__ import annotations

import asyncio
import time
from concurrent.futures import wait
from types import TracebackType
from typing import Any, AsyncIterator, Iterator

from ._driver import Driver, Request
from .errors import DeltarobotError
from .messages import Status
from .session import Health, Settings

BAUDRATE = 115200


class Robot:
    """A robot: `with Robot("/dev/ttyACM0") as robot: robot.home()`.

    The port is a name or a URL that pyserial takes (`COM5`, `socket://robot:2001`, `rfc2217://robot:2001`), or an open
    pyserial object, which stays open. Methods raise `Refused`, `Failed`, `Cancelled`, `TimedOut` or `Disconnected`.

    They can be called from any thread, `cancel` while another waits for a motion. Ctrl-C, and leaving the `with` block
    while the robot moves, cancel the motion.
    """

    def __init__(self, port: Any, baudrate: int = BAUDRATE, settings: Settings = Settings()) -> None:
        self._driver = Driver(port, baudrate, settings)

    def __enter__(self) -> Robot:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Cancels the motion that is going on, if any, and closes the port."""
        self._driver.close()

    def home(self) -> None:
        """Homes the robot and returns when it stands."""
        self._wait(self.start_home())

    def move(self, a: float, b: float, c: float) -> None:
        """Moves to a position and returns when the robot is there."""
        self._wait(self.start_move(a, b, c))

    def start_home(self) -> Request:
        """Requests homing and returns at once: the end is the future's result."""
        return self._driver.home()

    def start_move(self, a: float, b: float, c: float) -> Request:
        """Requests a move and returns at once: the end is the future's result."""
        return self._driver.move(a, b, c)

    def cancel(self) -> None:
        """Cancels the motion that is going on, which ends with `Cancelled`; returns when the controller has agreed."""
        self._driver.cancel().result()

    def status(self) -> Status:
        """Asks for the status."""
        status = self._driver.status().result()
        assert status is not None
        return status

    def states(self, interval: float = 0.2, until: Request | None = None) -> Iterator[Status]:
        """The status every so many seconds: for ever, or until a request has ended."""
        while True:
            # Asked for after the end, too: so the last one tells where it ended.
            over = until is not None and until.done()
            yield self.status()
            if over:
                return
            time.sleep(interval)

    @property
    def health(self) -> Health:
        """The statistics of the link."""
        return self._driver.health

    def _wait(self, request: Request) -> None:
        try:
            # In pieces: in Windows, a wait without an end can't be interrupted.
            while not wait([request], 0.5).done:
                pass
            request.result()
        except KeyboardInterrupt:
            try:
                self.cancel()
                request.exception()
            except DeltarobotError:
                pass
            raise


class AsyncRobot:
    """A robot for asyncio: `async with AsyncRobot("/dev/ttyACM0") as robot: await robot.home()`.

    As `Robot`, but that a task which is cancelled while it waits for a motion (by `asyncio.timeout`, say) cancels the
    motion, and ends when the platform stands.
    """

    def __init__(self, port: Any, baudrate: int = BAUDRATE, settings: Settings = Settings()) -> None:
        self._arguments = (port, baudrate, settings)
        self._opened: Driver | None = None

    async def __aenter__(self) -> AsyncRobot:
        self._opened = await asyncio.to_thread(Driver, *self._arguments)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await asyncio.to_thread(self._driver.close)

    @property
    def _driver(self) -> Driver:
        if self._opened is None:
            raise RuntimeError("use it in `async with`")
        return self._opened

    async def home(self) -> None:
        """Homes the robot and returns when it stands."""
        await self._motion(self._driver.home())

    async def move(self, a: float, b: float, c: float) -> None:
        """Moves to a position and returns when the robot is there."""
        await self._motion(self._driver.move(a, b, c))

    async def cancel(self) -> None:
        """Cancels the motion that is going on, which ends with `Cancelled`; returns when the controller has agreed."""
        await asyncio.wrap_future(self._driver.cancel())

    async def status(self) -> Status:
        """Asks for the status."""
        status = await asyncio.wrap_future(self._driver.status())
        assert status is not None
        return status

    async def states(self, interval: float = 0.2) -> AsyncIterator[Status]:
        """The status every so many seconds, for ever."""
        while True:
            yield await self.status()
            await asyncio.sleep(interval)

    @property
    def health(self) -> Health:
        """The statistics of the link."""
        return self._driver.health

    async def _motion(self, request: Request) -> None:
        try:
            await asyncio.wrap_future(request)
        except asyncio.CancelledError:
            try:
                self._driver.cancel()
                await asyncio.wrap_future(request)
            except DeltarobotError:
                pass
            raise
