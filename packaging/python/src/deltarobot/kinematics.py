"""The platform's geometry, on numpy arrays: the last axis is one pose, or one triple of leg lengths.

>>> robot = Configuration((0.12, 0, 0.10), (0.38, 0, 0.25), (0.12, 0, 0.40), 0.15, 0.08)
>>> inverse(robot, (0.25, 0.4, 0.25)).round(3)
array([0.427, 0.379, 0.427], dtype=float32)
>>> forward(robot, inverse(robot, [(0.25, 0.4, 0.25), (0.26, 0.4, 0.25)])).round(3)
array([[0.25, 0.4 , 0.25],
       [0.26, 0.4 , 0.25]], dtype=float32)
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass
from itertools import chain
from typing import Any, Callable

import numpy
from numpy.typing import ArrayLike, NDArray

from ._library import ffi, lib

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Configuration:
    """The robot's measures, in any unit of length: where the legs are joined to the base, and two of the platform."""

    A1: Point
    A2: Point
    A3: Point
    d_B1B3: float
    d_e: float

    def __post_init__(self) -> None:
        *points, edge, distance = astuple(self)
        if not all(map(math.isfinite, (*chain(*points), edge, distance))) or points[0] == points[2]:
            raise ValueError("a robot has finite measures, and A1 and A3 are two points")


def inverse(configuration: Configuration, poses: ArrayLike) -> NDArray[numpy.float32]:
    """The leg lengths of poses; three NaNs for those where the platform's direction is not defined."""
    return _each(lib.dp_kinematics_inverse, configuration, poses)


def forward(configuration: Configuration, lengths: ArrayLike) -> NDArray[numpy.float32]:
    """The poses of leg lengths; three NaNs for those that no pose has."""
    return _each(lib.dp_kinematics_forward, configuration, lengths)


def _each(function: Callable[..., int], configuration: Configuration, values: ArrayLike) -> NDArray[numpy.float32]:
    robot: Any = ffi.new("struct dp_robot_configuration *", astuple(configuration))
    given = numpy.ascontiguousarray(values, dtype=numpy.float32)
    if given.ndim == 0 or given.shape[-1] != 3:
        raise ValueError(f"the last axis has three numbers, not {given.shape}")
    found = numpy.full_like(given, numpy.nan)
    source, target = ffi.from_buffer("float[]", given), ffi.from_buffer("float[]", found, require_writable=True)
    for first in range(0, given.size, 3):
        function(robot, source + first, target + first)  # without a result it leaves the NaNs
    return found
