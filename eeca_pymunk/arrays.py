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
    places: list[tuple[tuple[int, ...], npt.DTypeLike, int]] = []
    total, unit = 0, _LINES
    for shape, dtype in wanted:
        places.append((shape, dtype, total))
        size = math.prod(shape) * np.dtype(dtype).itemsize
        total += -(-size // _LINES) * _LINES
    if total >= _PAGE // 2:
        total, unit = max(-(-total // _PAGE) * _PAGE, _HUGE), _PAGE
    memory = np.zeros(total + unit, np.uint8)
    first = -memory.__array_interface__["data"][0] % unit
    return [np.ndarray(shape, dtype, memory, first + at) for shape, dtype, at in places]


def rotated(vectors: FloatArray, angle: FloatArray) -> FloatArray:
    """(..., 2) vectors rotated by angles (...)."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack((c * x - s * y, s * x + c * y), axis=-1)
