"""The library of kernels: loaded by ctypes, called by cffi.

An entry is the C function

    int64_t eeca_ROOM_MODULE_FUNCTION(const int64_t *words, numbers...),

where `words` has the address of each array followed by its lengths, and the address of each table's words. Numbers are
doubles and 64-bit integers. It returns what the kernel returns, or one of the two codes below.
"""

from __future__ import annotations

import ctypes
import enum
import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import _cffi_backend

from ..arrays import address_of
from .entries import ENTRIES, dtype_of, is_array
from .sources import sources_hash

NO_MEMORY, NO_SHAPE = -(1 << 63), -(1 << 63) + 1  # returned if an array cannot be created; if shapes do not fit
_ffi = _cffi_backend.FFI()
_CALLS = 4  # number of results of `Entry.bind` that are kept
_WORDS = _ffi.typeof("int64_t[]")


class Status(enum.Enum):
    """The result of looking for a library, and of loading it."""

    LOADED = "loaded"
    MISSING = "there is none of these sources for this platform"
    UNREADABLE = "the system cannot load it"
    UNMARKED = "it is no library of kernels: it carries no hash"
    OUTDATED = "it carries the hash of other sources"
    INCOMPLETE = "it lacks an entry point"
    UNKNOWN = "the sources, whose hash it has to carry, cannot be read"


def c_name(name: str) -> str:
    """The C name of the entry "room.module:function"."""
    return "eeca_" + name.replace(".", "_").replace(":", "_")


def result_of(name: str, status: int) -> int:
    """The result of an entry.

    Raises:
        MemoryError: there was no memory for an array.
        ValueError: the shapes of arrays do not fit.
    """
    if status <= NO_SHAPE:
        raise MemoryError(name) if status == NO_MEMORY else ValueError(f"{name}: arrays do not fit")
    return status


class Entry:
    """One entry point, the C function at this address, called with arrays and numbers as its kernel is."""

    def __init__(self, name: str, address: int, kinds: str = "") -> None:
        self.name = name
        self.kinds = (kinds or ENTRIES[name]).split()
        numbers = ["double" if kind == "f8" else "int64_t" for kind in self.kinds if not is_array(kind)]
        self.function: Callable[..., int] = _ffi.cast(f"int64_t(*)({', '.join(['int64_t *', *numbers])})", address)
        # Results of the last calls of `bind`, which keep their arrays alive, by the identities of these: scenes take
        # turns (`impacts/scene_memory.py`).
        self._calls: dict[tuple[int, ...], Callable[..., int]] = {}
        self._arrays = [i for i, kind in enumerate(self.kinds) if is_array(kind)]
        # None for tables.
        self._wanted = [None if (kind := self.kinds[i]).endswith("}") else dtype_of(kind) for i in self._arrays]
        self._numbers = [i for i, kind in enumerate(self.kinds) if not is_array(kind)]

    def __call__(self, *args: Any) -> int:
        if len(args) != len(self.kinds):
            raise TypeError(f"{self.name} takes {len(self.kinds)} arguments, not {len(args)}")
        call = self.bind(*[args[i] for i in self._arrays])
        return result_of(self.name, call(*[args[i] for i in self._numbers]))

    def bind(self, *arrays: Any) -> Callable[..., int]:
        """The entry with these arrays: a function of its numbers, whose result `result_of` takes; that of one of the
        last calls, if it was for the same arrays.

        Raises:
            TypeError: an array is not of the declared dtype and dimensions, or not C-contiguous.
        """
        key = tuple(map(id, arrays))
        known = self._calls.get(key)
        if known is not None:
            return known
        words: list[int] = []
        for place, (wanted, array) in enumerate(zip(self._wanted, arrays, strict=True)):
            if wanted is None:
                words.append(array.address)
                continue
            dtype, ndim = wanted
            if array.dtype != dtype or array.ndim != ndim or not array.flags.c_contiguous:
                raise TypeError(
                    f"{self.name} takes a C-contiguous {self.kinds[self._arrays[place]]}, not "
                    f"{array.dtype.type.__name__} of shape {array.shape} with strides {array.strides}"
                )
            words.append(address_of(array))
            words += array.shape
        # A pointer is passed in half the time of a number.
        call = functools.partial(self.function, _ffi.new(_WORDS, words))
        call.kept = arrays  # type: ignore[attr-defined] # as long as their addresses are used
        calls = [*self._calls.items()][1 - _CALLS :]
        self._calls = {**dict(calls), key: call}
        return call


def load(path: Path | None) -> tuple[Status, dict[str, Entry], str]:
    """The entries of a library, if it is one of these sources.

    Returns:
        the status; the entries by name, none unless LOADED; and what the system or the library says.
    """
    if path is None:
        return Status.MISSING, {}, ""
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        return Status.UNREADABLE, {}, str(error)
    try:
        carried = (ctypes.c_char * 32).in_dll(library, "eeca_sources").value.decode("ascii", "replace")
    except ValueError:
        return Status.UNMARKED, {}, ""
    if carried != sources_hash():
        return Status.OUTDATED, {}, f"{carried}, not {sources_hash()}"
    entries = {}
    for name in ENTRIES:
        try:
            address = ctypes.cast(getattr(library, c_name(name)), ctypes.c_void_p).value
        except AttributeError:
            return Status.INCOMPLETE, {}, name
        entries[name] = Entry(name, address or 0)
    return Status.LOADED, entries, ""
