"""Prefetching: rows are loaded into the cache before they are needed.

Scenes of thousands of bodies exceed a processor's caches, and the next event is usually elsewhere in memory. A kernel
that knows its place lets that row be loaded while it computes. No result depends on it.
"""

from __future__ import annotations

from ..arrays import AnyArray
from .kernels import Compilable


class Fetch(Compilable):
    """`fetch(TABLE, row, column)`: load the cache line that holds this element of a (rows, columns) or (rows,) array;
    of records, the field at that place of the row. Nothing happens where there is none, or in plain Python."""

    def __call__(self, table: AnyArray, row: int, column: int) -> None:
        """Plain Python loads nothing ahead."""


fetch = Fetch()
