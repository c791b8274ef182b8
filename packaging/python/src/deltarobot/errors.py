"""What can go wrong. All of it is a `DeltarobotError`."""

from __future__ import annotations


class DeltarobotError(Exception):
    """The base of this package's exceptions."""


class Busy(DeltarobotError):
    """A request of this kind is going on."""


class Refused(DeltarobotError):
    """The controller did not accept the request: it does not know its position, say, or is at error."""


class Failed(DeltarobotError):
    """The controller accepted the request, and could not carry it out."""


class Cancelled(DeltarobotError):
    """The motion was cancelled; the platform stands."""


class TimedOut(DeltarobotError, TimeoutError):
    """Too many answers stayed away, or the motion lasted too long. What the platform does is not known."""


class Disconnected(DeltarobotError, ConnectionError):
    """The port can't be opened, is closed, or has failed; its own error is the cause."""


class Malformed(DeltarobotError, ValueError):
    """What was read is not of the form asked for."""
