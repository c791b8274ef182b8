"""Drives a robot that speaks the deltarobot message format; reads and writes the messages of three protocols.

`Robot` and `AsyncRobot` drive a robot at a port; `Session` does without I/O; `Receiver` and `Message` are the format
itself. The modules `line`, `gx` and `kinematics` (which needs numpy) have the other protocols and the geometry.
"""

from ._library import version as __version__
from .errors import Busy, Cancelled, DeltarobotError, Disconnected, Failed, Malformed, Refused, TimedOut
from .messages import Layout, Message, Opcode, Position, Receiver, State, Status, Stops
from .robot import AsyncRobot, Robot
from .session import Event, EventKind, Health, Outcome, Session, Settings

__all__ = [
    "AsyncRobot",
    "Busy",
    "Cancelled",
    "DeltarobotError",
    "Disconnected",
    "Event",
    "EventKind",
    "Failed",
    "Health",
    "Layout",
    "Malformed",
    "Message",
    "Opcode",
    "Outcome",
    "Position",
    "Receiver",
    "Refused",
    "Robot",
    "Session",
    "Settings",
    "State",
    "Status",
    "Stops",
    "TimedOut",
    "__version__",
]
