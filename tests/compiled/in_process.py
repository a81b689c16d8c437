"""Any kernel as machine code of this process, whose numba is changed by that: for tests of the compiler."""

from __future__ import annotations

import functools
from typing import Any

import llvmlite.binding as llvm

from eeca_pymunk.compiled.frontend.calls import Call
from eeca_pymunk.compiled.frontend.jit import loaded
from eeca_pymunk.compiled.frontend.module import Group, linked, machine_of, optimise
from eeca_pymunk.compiled.frontend.parts import Part, part_of
from eeca_pymunk.compiled.frontend.types import declared_type
from eeca_pymunk.compiled.kernels import Kernel
from eeca_pymunk.compiled.library import Entry, c_name


def call_of(kernel: Kernel[..., Any], kinds: str) -> Call:
    """A kernel and its arguments as `entries.py` writes them."""
    return kernel, tuple(map(declared_type, kinds.split()))


def reached(first: Call) -> dict[Call, Part]:
    """The parts of a call and of all that it calls."""
    found: dict[Call, Part] = {}
    waiting = [first]
    while waiting:
        call = waiting.pop()
        if call not in found:
            found[call] = part_of(call)
            waiting += found[call].calls
    return found


@functools.cache
def compiled(kernel: Kernel[..., Any], kinds: str) -> Entry:
    """A kernel that returns an integer or nothing."""
    call = call_of(kernel, kinds)
    found = reached(call)
    group = Group([(kernel.name, found[call].returned)], [part.bitcode for part in found.values()])
    module = linked(group, {kernel.name: call})
    machine = machine_of(llvm.get_process_triple(), llvm.get_host_cpu_name(), here=True)
    optimise(module, machine)
    engine = loaded(bytes(machine.emit_object(module)))
    return Entry(kernel.name, engine.get_function_address(c_name(kernel.name)), kinds)
