"""Names of numpy's array types, arrays in one piece of memory, and the rotation of vectors."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.intp]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
PoolArray: TypeAlias = npt.NDArray[np.int32]
FlagArray: TypeAlias = npt.NDArray[np.uint8]
AnyArray: TypeAlias = npt.NDArray[Any]


_LINES = 128  # bytes: alignment of what a processor fetches at once
_PAGE = 1 << 21  # bytes of a huge page
_HUGE = 1 << 22  # bytes of an allocation from which numpy asks for huge pages


def side_by_side(*wanted: tuple[tuple[int, ...], npt.DTypeLike]) -> list[Any]:
    """Arrays of zeros of these shapes and dtypes in one piece of memory, each aligned to a cache line.

    Kernels read a few numbers in all arrays of a scene, and would often miss the TLB with many small pages. Large
    scenes therefore get huge pages, which operating systems only give to large allocations.
    """
    kinds = [np.dtype(dtype) for _, dtype in wanted]
    sizes = [math.prod(shape) * kind.itemsize for (shape, _), kind in zip(wanted, kinds, strict=True)]
    rooms = [-(-size // _LINES) * _LINES for size in sizes]
    total, unit = sum(rooms), _LINES
    if total >= _PAGE // 2:
        total, unit = max(-(-total // _PAGE) * _PAGE, _HUGE), _PAGE
    memory = np.zeros(total + unit, np.uint8)
    at = -memory.ctypes.data % unit
    found: list[Any] = []
    for (shape, _), kind, room in zip(wanted, kinds, rooms, strict=True):
        found.append(np.ndarray(shape, kind, memory, at))
        at += room
    return found


def rotated(vectors: FloatArray, angle: FloatArray) -> FloatArray:
    """(..., 2) vectors rotated by angles (...)."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack((c * x - s * y, s * x + c * y), axis=-1)
