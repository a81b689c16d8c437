"""Kernels compiled in this process: each entry point at its first call, with all that it reaches."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Mapping
from typing import Any

import llvmlite.binding as llvm

from ..entries import ENTRIES
from ..kernels import Kernel
from ..library import Entry, symbol
from . import store
from .calls import Call
from .module import entry_call, linked_call, machine_of, optimise
from .parts import Part, part_of
from .types import declared_type

_lock = threading.RLock()
_engines: list[Any] = []  # which own the code


class _Entry(Entry):
    """An entry point that is compiled when it is first called."""

    def __init__(self, name: str) -> None:
        super().__init__(name, 0)
        self._there = False

    def bind(self, *arrays: Any) -> Callable[..., int]:
        self.ready()
        return super().bind(*arrays)

    def ready(self) -> None:
        """Compile it, if it has not been called."""
        with _lock:
            if not self._there:
                self._there = True
                self.point_to(address_of(self.name, entry_call(self.name)))


def entries() -> Mapping[str, Entry]:
    """All entry points, none of them compiled."""
    return {name: _Entry(name) for name in ENTRIES}


def ready(kernel: Kernel[Any, Any]) -> None:
    """Compile this entry point, if it has not been called."""
    if isinstance(entry := kernel.run, _Entry):
        entry.ready()


def reached(first: list[Call]) -> dict[Call, Part]:
    """The parts of these calls and of all that they call, compiled or read from the store."""
    found: dict[Call, Part] = {}
    waiting = first[::-1]
    while waiting:
        call = waiting.pop()
        if call in found:
            continue
        part = store.read_part(call)
        if part is None:
            part = part_of(call)
            store.write_part(call, part)
        found[call] = part
        waiting += part.calls
    return found


def address_of(name: str, call: Call) -> int:
    """Compile a kernel for these types of arguments, and all that it calls, as code of this processor."""
    found = reached([call])
    module = linked_call(name, call, found[call].returned, [part.bitcode for part in found.values()])
    machine = machine_of(llvm.get_process_triple(), llvm.get_host_cpu_name(), here=True)
    optimise(module, machine)
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    _engines.append(engine)
    return int(engine.get_function_address(symbol(name)))


@functools.cache
def compiled(kernel: Kernel[Any, Any], kinds: str) -> Entry:
    """Any kernel that returns an integer as machine code, for arguments as `..entries` writes them."""
    call = kernel, tuple(map(declared_type, kinds.split()))
    with _lock:
        return Entry(kernel.name, address_of(kernel.name, call), kinds)
