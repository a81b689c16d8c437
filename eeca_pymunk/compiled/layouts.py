"""Layouts: the arrays of a table side by side in one piece of memory, which the next ones overwrite.

A `Plan` says which arrays a table has, their dtypes, and which of their lengths vary; `Layout.lay` gives them so many
rows each. It only writes the words of the table (address, size and lengths of each array, see `tables.py`), by a
kernel: all that machine code needs. numpy's arrays, which take twenty times as long, are made when Python asks the
table for them.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Generic, TypeVar

import numpy as np

from ..arrays import LINE, AnyArray, IntArray, Memory, address_of, lengths
from .backend import start
from .entries import table_fields
from .kernels import Kernel, nonallocating
from .tables import WORDS, Pointers, Table, array_words

T = TypeVar("T")
ROWS = -1


@nonallocating
def lay_out(PLAN: IntArray, SIZES: IntArray, TABLE: IntArray, address: int) -> int:
    """Write the words of a arrays, of which the last g are in other memory.

    Args:
        PLAN (a, 5): of each array, its first word; bytes and numbers of a row; two lengths, ROWS for the rows.
        SIZES (a + g,): how many rows each has; then the addresses of the last g arrays.  TABLE: out, the words.
        address: of the memory in which the first a - g arrays lie side by side.

    Returns:
        the bytes of that memory.
    """
    arrays, at = PLAN.shape[0], 0
    own = 2 * arrays - SIZES.shape[0]  # a - g
    for a in range(arrays):
        word, count = PLAN[a, 0], SIZES[a]
        TABLE[word] = SIZES[arrays + a - own] if a >= own else address + at
        TABLE[word + 1] = count * PLAN[a, 2]
        for k in range(2):
            TABLE[word + 2 + k] = count if PLAN[a, 3 + k] == ROWS else PLAN[a, 3 + k]
        at += (count * PLAN[a, 1] + LINE - 1) // LINE * LINE if a < own else 0
    return at


class Plan(Generic[T]):
    """Which arrays a table has, for its `Layout`; one plan serves many.

    Args:
        kind: named tuple of the arrays, one of `entries.TABLES`.
        own: the arrays in the memory of the layout, in this order; of which the first `zeros` are 0, the rest of any
            content.
        elsewhere: arrays in other memory.  constant: others, which stay the same.
        dimensions: of arrays with more than one, ROWS for the number of rows.
    """

    def __init__(
        self, kind: type[T], own: Sequence[str], zeros: int, elsewhere: Sequence[str],
        constant: Mapping[str, AnyArray], dimensions: Mapping[str, tuple[int, ...]],
    ) -> None:  # fmt: skip
        self.kind, self.own, self.elsewhere, self.constant = kind, tuple(own), tuple(elsewhere), dict(constant)
        self.names = self.own + self.elsewhere
        fields = table_fields(kind.__name__)
        self.place = {name: i for i, name in enumerate(self.names)}
        self.first_word = {name: WORDS * i for i, (name, *_) in enumerate(fields)}
        self.dtypes = {name: dtype for name, dtype, _ in fields}
        self.dimensions = {name: dimensions.get(name, (ROWS,) * many) for name, _, many in fields}
        self.words: IntArray = np.zeros(WORDS * len(fields), np.int64)
        rows = []
        for name in self.names:
            shape, dtype = self.dimensions[name], self.dtypes[name]
            width = math.prod(length for length in shape if length != ROWS)
            rows.append((self.first_word[name], width * dtype.itemsize, width, *lengths(shape)))
        self.rows: IntArray = np.array(rows, np.int64)
        for name, array in constant.items():
            self.words[self.first_word[name] :][:WORDS] = array_words(array)
        self.end = self.first_word[own[zeros]] if zeros < len(own) else None


class Layout(Generic[T]):
    """Memory for the arrays of one table after the other.

    Attributes:
        table: the last one.
    """

    def __init__(self, plan: Plan[T]) -> None:
        self._plan, words = plan, plan.words.copy()
        self._table = words.data
        self._sizes = np.zeros(len(plan.rows) + len(plan.elsewhere), np.int64)
        self._put, self._into = struct.Struct(f"{len(self._sizes)}q").pack_into, self._sizes.data
        self._write = lay_out.bind(plan.rows, self._sizes, words)
        self._memory = Memory()
        self._pointers = Pointers(tuple, words) if start().entries else None
        self.table: Table = self._pointers
        self._calls: dict[tuple[Kernel[..., Any], ...], list[Callable[..., Any]]] = {}

    def lay(self, counts: Mapping[str, int], *elsewhere: AnyArray) -> Table:
        """The table of arrays with so many rows each, 1 of records, also of those elsewhere; the last table is lost."""
        self._put(self._into, 0, *map(counts.__getitem__, self._plan.names), *map(address_of, elsewhere))
        for name in () if self._pointers is None else self._pointers.others:  # these are of the last table only
            first = self._plan.first_word[name]
            self._table[first : first + WORDS] = self._plan.words.data[first : first + WORDS]
        memory = self._memory
        address = memory.address
        total = self._write(address)
        memory.provide(total if self._plan.end is None else self._table[self._plan.end] - address, total)
        if memory.address != address:
            self._write(memory.address)
        if self._pointers is None:
            self._calls.clear()
            self.table = self._arrays(elsewhere)
        else:
            self._pointers.make_by(partial(self._arrays, elsewhere))
        return self.table

    def bound(self, *kernels: Kernel[..., Any]) -> list[Callable[..., Any]]:
        """Kernels with the last table as their first argument; in machine code they are made once for all tables."""
        calls = self._calls.get(kernels)
        if calls is None:
            calls = self._calls[kernels] = [one.bind(self.table) for one in kernels]
        return calls

    def _arrays(self, elsewhere: Sequence[AnyArray]) -> T:
        """The arrays of the last table."""
        plan = self._plan
        others = dict(zip(plan.elsewhere, elsewhere, strict=True))
        return plan.kind(**plan.constant, **others, **{name: self.array(name) for name in plan.own})

    def array(self, name: str) -> Any:
        """An array of this memory in the last table."""
        plan = self._plan
        count, at = self._into[plan.place[name]], self._table[plan.first_word[name]] - self._memory.address
        shape = plan.dimensions[name]
        shape = (count,) if len(shape) == 1 else tuple([count if length == ROWS else length for length in shape])
        array = self._memory.array(shape or (1,), plan.dtypes[name], at)
        return array if shape else array[0]

    def write(self, name: str, content: bytes | bytearray, start: int = 0) -> None:
        """Write an array of this memory in the last table, from byte `start` on."""
        first = self._table[self._plan.first_word[name]] - self._memory.address + start
        self._memory.raw[first : first + len(content)] = content

    def floats(self, name: str) -> memoryview:
        """The numbers of an array of this memory in the last table."""
        return self._memory.floats[self._part(name)]

    def integers(self, name: str) -> memoryview:
        """The same of an array of integers, or the memory of another one as integers."""
        return self._memory.integers[self._part(name)]

    def _part(self, name: str) -> slice:
        word = self._plan.first_word[name]
        first = (self._table[word] - self._memory.address) // 8
        return slice(first, first + self._table[word + 1] * self._plan.dtypes[name].itemsize // 8)
