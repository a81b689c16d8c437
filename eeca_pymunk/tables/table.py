"""Many arrays behind one pointer.

A scene has some thirty arrays. numba would take each of them apart at every call from Python, count references to it,
and hand all of them by value from kernel to kernel. `table_of` writes down once where the arrays are and how long they
are; a kernel that Python calls takes these numbers, and an `Opener` makes of them, at no cost, what has the arrays as
attributes. Without numba a table is the named tuple of arrays itself.
"""

from __future__ import annotations

from typing import Any, Generic, TypeAlias, TypeVar

import numpy as np

from ..compiled import compiler

T = TypeVar("T")
Table: TypeAlias = Any  # of `table_of`
WORDS = 4  # numbers of an array: address, size, and its shape, one or two lengths (of three, the last two)

fields: dict[str, tuple[tuple[str, str, int], ...]] = {}  # of a named tuple: names, dtypes, dimensions of its arrays


def table_of(arrays: Any) -> Table:
    """What kernels take for a named tuple of arrays. To be made anew when one of them is replaced by another; the
    arrays have to be kept as long as the table is used.

    Raises:
        TypeError: an array is not C-contiguous, or of another kind than in the tables before.
    """
    if compiler() is None:
        return arrays
    name = type(arrays).__name__
    kinds = tuple((field, a.dtype.str, a.ndim) for field, a in zip(arrays._fields, arrays, strict=True))
    if fields.setdefault(name, kinds) != kinds:
        raise TypeError(f"the arrays of this {name} are {kinds}, those before were {fields[name]}")
    numbers = np.zeros((len(arrays), WORDS), np.int64)
    for row, field, a in zip(numbers, arrays._fields, arrays, strict=True):
        if not a.flags.c_contiguous:
            raise TypeError(f"{name}.{field} of shape {a.shape} has strides {a.strides}: it must be C-contiguous")
        row[0], row[1] = a.ctypes.data, a.size
        row[2:] = (a.shape * 2)[-2:] if a.ndim == 1 else a.shape[-2:]
    return numbers.ravel()


class Opener(Generic[T]):
    """Makes of a table the named tuple that it was made of, as far as kernels can tell: its arrays are attributes."""

    def __init__(self, kind: type[T]) -> None:
        self.kind = kind

    def __call__(self, table: Table) -> T:
        opened: T = table
        return opened

    @property
    def _numba_type_(self) -> Any:
        # What numba asks a global of a kernel for.
        from .pointers import opener

        return opener(self.kind.__name__)
