"""Names of numpy's array types, arrays in one piece of memory, and the rotation of vectors."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import _cffi_backend
import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.intp]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
PoolArray: TypeAlias = npt.NDArray[np.int32]
FlagArray: TypeAlias = npt.NDArray[np.uint8]
AnyArray: TypeAlias = npt.NDArray[Any]


_ffi = _cffi_backend.FFI()
_ADDRESS = _ffi.typeof("uintptr_t")
LINE = 128  # bytes: alignment of what a processor fetches at once
_PAGE = 1 << 21  # bytes of a huge page
_HUGE = 1 << 22  # bytes of an allocation from which numpy asks for huge pages
_SPARE = 4  # memory is replaced if larger than this times the need plus a huge page


def address_of(array: Any) -> int:
    """Memory address of an array, or of a record in one."""
    # numpy's `ctypes` takes four times as long; `__array_interface__`, which describes all fields of records, forty.
    return int(_ffi.cast(_ADDRESS, _ffi.from_buffer(array)))


def lengths(shape: tuple[int, ...]) -> tuple[int, ...]:
    """The two lengths of an array that its table stores (`compiled.tables`): the last two, its only one twice, 0 of a
    record."""
    return shape * 2 if len(shape) == 1 else shape[-2:] if shape else (0, 0)


class Memory:
    """Memory for successive sets of arrays: while it is large enough, each set replaces the last one in place.

    Attributes:
        address: where it begins, aligned to a cache line.
    """

    def __init__(self) -> None:
        self._allot(0)

    def provide(self, zeros: int, total: int) -> None:
        """Make room for `total` bytes, of which the first `zeros` are 0; the content before is lost.

        Kernels read a few numbers in all arrays of a scene, and would often miss the TLB with many small pages. Large
        scenes therefore get huge pages, which operating systems only give to large allocations.
        """
        if total <= len(self.bytes) <= _SPARE * (total + _PAGE):
            self.bytes[:zeros] = 0
        else:
            self._allot(total + total // 2 if len(self.bytes) else total)

    def array(self, shape: tuple[int, ...], dtype: npt.DTypeLike, at: int) -> Any:
        """An array that begins at this byte."""
        return np.ndarray(shape, dtype, self.bytes, at)

    def _allot(self, total: int) -> None:
        """New memory, zeros, with room for so many bytes."""
        huge = total >= _PAGE // 2
        size, unit = (max(-(-total // _PAGE) * _PAGE, _HUGE), _PAGE) if huge else (-(-total // LINE) * LINE, LINE)
        room = np.zeros(size + unit, np.uint8)
        first = -address_of(room) % unit
        self.bytes: FlagArray = room[first : first + size]
        self.address = address_of(room) + first
        self.raw = self.bytes.data
        self.floats = self.bytes.view(np.float64).data
        self.integers = self.bytes.view(np.int64).data


def side_by_side(*wanted: tuple[tuple[int, ...], npt.DTypeLike]) -> list[Any]:
    """Arrays of zeros of these shapes and dtypes in one piece of memory of their own, each aligned to a cache line."""
    places: list[tuple[tuple[int, ...], np.dtype[Any], int]] = []
    total = 0
    for shape, kind in wanted:
        dtype = np.dtype(kind)
        places.append((shape, dtype, total))
        total += -(-math.prod(shape) * dtype.itemsize // LINE) * LINE
    memory = Memory()
    memory.provide(total, total)
    return [memory.array(*place) for place in places]


def rotate_all(vectors: FloatArray, angle: FloatArray) -> FloatArray:
    """(..., 2) vectors rotated by angles (...)."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack((c * x - s * y, s * x + c * y), axis=-1)
