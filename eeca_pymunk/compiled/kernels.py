"""The decorators of kernels, and the code that a decorated function runs.

A kernel takes arrays and numbers, returns numbers or a status, and does not use pymunk. Every kernel annotates its
arguments and what it returns: the builder types calls by these annotations, so that kernels compile one by one.
"""

from __future__ import annotations

import functools
import threading
import typing
from collections.abc import Callable
from typing import Any, Generic, ParamSpec, TypeVar

import numpy as np

from ..arrays import AnyArray
from .backend import Backend, start

P = ParamSpec("P")
R = TypeVar("R")

_kernels: list[Kernel[Any, Any]] = []
_ready = 0  # the first so many of that list have their `run`
_lock = threading.RLock()
_types: Callable[[Any], Any] | None = None  # the compiler's types of kernels, openers and `fetch`


class Compilable:
    """Objects that kernels may use as globals; the active compiler gives each a type."""

    @property
    def _numba_type_(self) -> Any:
        # numba reads this attribute of globals that it does not know.
        if _types is None:
            raise AttributeError("no compiler is active")
        return _types(self)


class Fetch(Compilable):
    """`fetch(TABLE, row, column)`: load the cache line that holds this element of a (rows, columns) or (rows,) array;
    of records, the field at that place of the row. Nothing happens where there is none, or in plain Python.

    Scenes of thousands of bodies exceed a processor's caches, and the next event is usually elsewhere in memory. A
    kernel that has its index lets that row be loaded while it computes. No result depends on it.
    """

    def __call__(self, table: AnyArray, row: int, column: int) -> None:
        """Plain Python loads nothing ahead."""


fetch = Fetch()


class Kernel(Compilable, Generic[P, R]):
    """A function that runs as machine code if there is any.

    Attributes:
        python: the function in Python.
        name: "room.module:function", which `entries.py` lists if Python calls it.
        run: the code that a call executes; calling `run` directly saves half a microsecond.
        counted: whether machine code counts references to arrays, see `nonallocating`.
        inlined: whether machine code is inlined into callers.
    """

    def __init__(self, python: Callable[P, R], counted: bool = True, inlined: bool = False) -> None:
        functools.update_wrapper(self, python)
        self.python = python
        self.counted, self.inlined = counted, inlined
        self.name = f"{python.__module__.partition('.')[2]}:{python.__name__}"
        self.run: Callable[P, R] = self._run_first
        _kernels.append(self)

    def _run_first(self, *args: P.args, **kwargs: P.kwargs) -> R:
        prepare()
        return self.run(*args, **kwargs)

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        return self.run(*args, **kwargs)

    def bind(self, *arrays: Any) -> Callable[..., R]:
        """The kernel with its arrays, the first arguments; returns a function of the other arguments.

        Addresses are read here, once: the arrays must not be resized or replaced.
        """
        prepare()
        bind = getattr(self.run, "bind", None)
        return functools.partial(self.run, *arrays) if bind is None else bind(*arrays)


class Choice(Compilable, Generic[R]):
    """Kernels that do the same with data of different types: a call is one of that whose first argument, a named tuple,
    has this type. Machine code has the choice made when it is compiled.

    Args:
        kernels: with arguments of the same names, and the same type of what they return.
    """

    def __init__(self, *kernels: Kernel[..., R]) -> None:
        self.kernels = kernels

    @functools.cached_property
    def of(self) -> dict[Any, Kernel[..., R]]:
        """The kernel for each type of the first argument."""
        hints = [(typing.get_type_hints(one.python), one) for one in self.kernels]
        return {next(iter(hint.values())): one for hint, one in hints}

    def __call__(self, first: Any, *args: Any) -> R:
        return self.of[type(first)].run(first, *args)


def kernel(python: Callable[P, R]) -> Kernel[P, R]:
    """A kernel that may create arrays."""
    return Kernel(python)


def nonallocating(python: Callable[P, R]) -> Kernel[P, R]:
    """A kernel that creates no arrays except views of its arguments. It is compiled without reference counting of
    arrays (numba's `_nrt=False`), which costs two locked instructions for each argument at every call."""
    return Kernel(python, counted=False)


def inlined(python: Callable[P, R]) -> Kernel[P, R]:
    """A nonallocating kernel whose machine code is inlined into its callers."""
    return Kernel(python, counted=False, inlined=True)


def kernels() -> dict[str, Kernel[Any, Any]]:
    """All imported kernels by name; of several with one name (those of tests) the one of this package."""
    return {one.name: one for one in sorted(_kernels, key=lambda one: one.python.__module__.startswith("eeca_pymunk."))}


def set_types(types: Callable[[Any], Any]) -> None:
    """Set the function by which a compiler types kernels, openers and `fetch`."""
    global _types
    _types = types


def prepare() -> Backend:
    """Set `run` of all kernels decorated since the last call; safe to call from any thread."""
    global _ready
    if _ready == len(_kernels):
        return start()
    with _lock:
        backend = start()
        fresh = _kernels[_ready:]
        for one in fresh:
            # numpy warns of divisions by 0 and the like, machine code does not.
            one.run = backend.entries.get(one.name) or np.errstate(all="ignore")(one.python)
        _ready += len(fresh)
    return backend
