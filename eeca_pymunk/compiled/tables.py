"""Many arrays behind one pointer.

A scene has some thirty arrays. `table_of` writes their addresses and lengths into one array, the table. A kernel that
Python calls takes the table, and an `Opener` (`scene_of` for a Scene) gives it the type of the named tuple, with the
arrays as attributes: in compiled code this is a cast and costs nothing. In plain Python a table is the named tuple.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Generic, TypeAlias, TypeVar

import numpy as np

from ..arrays import AnyArray, address_of, lengths
from .backend import start
from .entries import TABLES, table_fields
from .kernels import Compilable

T = TypeVar("T")
Table: TypeAlias = Any  # of `table_of`
WORDS = 4  # numbers of an array: address, size, and its shape, one or two lengths (of three, the last two)


class Pointers:
    """The table for machine code: `address` of its words, and the arrays, which it keeps alive; `make` makes them when
    they are asked for.

    Attributes:
        others: arrays that have replaced those of `make`, by name.
    """

    __slots__ = ("_arrays", "_make", "address", "others", "words")

    _arrays: Any
    others: dict[str, AnyArray]

    def __init__(self, make: Callable[[], Any], words: Any) -> None:
        self.words, self.address = words, address_of(words)
        self.make_by(make)

    def make_by(self, make: Callable[[], Any]) -> None:
        """Let `make` make the arrays."""
        self._make, self._arrays, self.others = make, None, {}

    def replace(self, name: str, array: AnyArray, words: Sequence[int], first: int) -> None:
        """Use another array of this name; its words are the table's from `first` on."""
        self.words[first : first + WORDS] = words
        self.others[name], self._arrays = array, None

    @property
    def arrays(self) -> Any:
        """The named tuple."""
        if self._arrays is None:
            made = self._make()
            self._arrays = made._replace(**self.others) if self.others else made
        return self._arrays


def _type_of(dtype: np.dtype[Any], dimensions: int) -> str:
    return f"{dtype.type.__name__}[{dimensions}]"


def table_of(arrays: Any) -> Table:
    """The table of a named tuple of arrays. If one of them is replaced, a new table is needed; the arrays must exist as
    long as the table is used.

    Raises:
        TypeError: an array is not C-contiguous, or not of the dtype and dimensions that `entries.TABLES` declares.
    """
    if not start().entries:
        return arrays
    name = type(arrays).__name__
    fields = table_fields(name) if name in TABLES else [(field, None, 0) for field in arrays._fields]
    numbers: list[int] = []
    for (field, dtype, dimensions), array in zip(fields, arrays, strict=True):
        numbers += _words(name, field, dtype, dimensions, array)
    return Pointers(lambda: arrays, np.array(numbers, np.int64))


def replaced(table: Table, kind: type[Any], name: str, array: AnyArray) -> Table:
    """The table of a named tuple of this kind with another array of this name: of machine code the same table, so that
    kernels stay bound to it."""
    if not isinstance(table, Pointers):
        return table._replace(**{name: array})
    fields = table_fields(kind.__name__)
    place = [field for field, *_ in fields].index(name)
    table.replace(name, array, _words(kind.__name__, *fields[place], array), WORDS * place)
    return table


def _words(name: str, field: str, dtype: np.dtype[Any] | None, dimensions: int, a: Any) -> tuple[int, ...]:
    """The numbers of one array, which has to be of this dtype, if given, and of as many dimensions."""
    if dtype is not None and (a.dtype != dtype or a.ndim != dimensions):
        raise TypeError(
            f"{name}.{field} is {_type_of(a.dtype, a.ndim)}; entries.TABLES declares {_type_of(dtype, dimensions)}"
        )
    if not a.flags.c_contiguous:
        raise TypeError(f"{name}.{field} of shape {a.shape} has strides {a.strides}: it must be C-contiguous")
    return array_words(a)


def array_words(array: Any) -> tuple[int, ...]:
    """The numbers of one array."""
    return address_of(array), array.size, *lengths(array.shape)


class Opener(Compilable, Generic[T]):
    """Function from a table to its named tuple, in kernels: the arrays are attributes."""

    def __init__(self, kind: type[T]) -> None:
        self.kind = kind

    def __call__(self, table: Table) -> T:
        opened: T = table.arrays if isinstance(table, Pointers) else table
        return opened
