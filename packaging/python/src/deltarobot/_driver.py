"""A thread that stands between a port and a session: `Robot` and `AsyncRobot` wait for what it reports."""

from __future__ import annotations

import threading
import time
from concurrent.futures import Future
from typing import Any, Callable

import serial

from .errors import Cancelled, DeltarobotError, Disconnected, Failed, Refused, TimedOut
from .messages import Message, Opcode, Status
from .session import Event, EventKind, Health, Outcome, Session, Settings

Request = Future[Status | None]

_ERRORS = {
    Outcome.REFUSED: Refused,
    Outcome.FAILED: Failed,
    Outcome.CANCELLED: Cancelled,
    Outcome.TIMED_OUT: TimedOut,
}
# How long a read waits where nothing can wake it up, and how long closing waits for the platform to stand.
_READ_SECONDS = 0.02
_STOP_SECONDS = 3.0


def _now_ms() -> int:
    return time.monotonic_ns() // 1_000_000


class Driver:
    def __init__(self, port: Any, baudrate: int, settings: Settings) -> None:
        self._is_ours = isinstance(port, str)
        try:
            if isinstance(port, str):
                port = serial.serial_for_url(port, baudrate=baudrate, exclusive=True)
            port.timeout = _READ_SECONDS
        except (OSError, ValueError) as error:
            raise Disconnected(str(error)) from error
        self._port = port
        self._session = Session(settings)
        self._lock = threading.Lock()
        self._waiting: dict[Opcode, Request] = {}
        self._status: Status | None = None
        self._end: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="deltarobot", daemon=True)
        self._thread.start()

    def home(self) -> Request:
        return self._request(Opcode.HOMING, self._session.home)

    def move(self, a: float, b: float, c: float) -> Request:
        return self._request(Opcode.MOVE, lambda: self._session.move(a, b, c))

    def cancel(self) -> Request:
        return self._request(Opcode.CANCEL, self._session.cancel, shared=True)

    def status(self) -> Request:
        return self._request(Opcode.STATUS, self._session.status, shared=True)

    def _request(self, opcode: Opcode, start: Callable[[], None], shared: bool = False) -> Request:
        with self._lock:
            if self._end:
                raise Disconnected(str(self._end)) from self._end
            if shared and opcode in self._waiting:
                return self._waiting[opcode]
            start()
            request: Request = Future()
            # Only the controller ends a request.
            request.set_running_or_notify_cancel()
            self._waiting[opcode] = request
        self._wake()
        return request

    @property
    def health(self) -> Health:
        with self._lock:
            return self._session.health

    def close(self) -> None:
        """Cancels a motion, waits until the platform stands or does not answer, and lets go of the port."""
        with self._lock:
            motions = [self._waiting[opcode] for opcode in (Opcode.HOMING, Opcode.MOVE) if opcode in self._waiting]
        try:
            if motions:
                self.cancel()
                motions[0].exception(_STOP_SECONDS)
        except (DeltarobotError, TimeoutError):
            pass
        self._stop(Disconnected("the port was closed"))
        self._wake()
        self._thread.join()
        if self._is_ours:
            self._port.close()

    def _wake(self) -> None:
        if hasattr(self._port, "cancel_read"):
            self._port.cancel_read()

    def _stop(self, end: BaseException) -> None:
        with self._lock:
            self._end = self._end or end
            waiting, self._waiting = self._waiting, {}
        for request in waiting.values():
            error = Disconnected(str(end))
            error.__cause__ = end
            request.set_exception(error)

    def _run(self) -> None:
        received = b""
        try:
            while not self._end:
                with self._lock:
                    events = []
                    while event := self._session.poll(_now_ms()):
                        events.append(event)
                    output = self._session.output(_now_ms())
                if output:
                    self._port.write(output)
                for event in events:
                    self._handle(event)
                if not received:
                    received = self._port.read(max(1, self._port.in_waiting))
                with self._lock:
                    received = received[self._session.receive(received, _now_ms()) :]
        except Exception as error:  # ports raise what they like
            self._stop(error)

    def _handle(self, event: Event) -> None:
        if event.status:
            self._status = event.status
        if event.kind != EventKind.ENDED or event.opcode is None:
            return
        with self._lock:
            request = self._waiting.pop(event.opcode, None)
        if request is None:
            return
        error = _ERRORS.get(event.outcome) if event.outcome else None
        if error:
            request.set_exception(error(f"{Message(event.opcode)} {error.__name__.lower()}"))
        else:
            request.set_result(self._status if event.opcode == Opcode.STATUS else None)
