"""The shared library that is part of this package, and what is asked of it everywhere."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from deltarobot._abi import ffi as _ffi

ffi: Any = _ffi
_names = ("libdeltarobot.so", "deltarobot.dll", "libdeltarobot.dylib")
lib: Any = ffi.dlopen(str(next(path for path in map(Path(__file__).with_name, _names) if path.exists())))

version: str = ffi.string(lib.dp_version()).decode()


def float32(value: float) -> float:
    """The number as C gets it; of one that no C float can hold, a ValueError instead of an infinity."""
    result: float = ffi.new("float *", value)[0]
    if math.isinf(result) and not math.isinf(value):
        raise ValueError(f"{value} is too large for a float")
    return result
