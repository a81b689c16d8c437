"""One LLVM module of all kernels that some entry points call, and its machine code."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.registry import cpu_target

from ..entries import ENTRIES
from ..kernels import kernels
from ..library import NO_MEMORY, NO_SHAPE, c_name
from . import calls, parts
from .calls import Call
from .types import declared_type

_INT, _FLOAT = ir.IntType(64), ir.DoubleType()
_POINTED = types.Array, types.Record
_NAMES = """
    acos asin atan atan2 calloc ceil copysign cos cosh exp floor fmod free frexp hypot ldexp log log10 log2 malloc
    memcpy memmove memset pow rint round sin sincos sinh sqrt tan tanh trunc
"""
C_LIBRARY = frozenset(_NAMES.split())
LEVEL = 2  # of optimisation: 3 takes longer and gains nothing that can be measured


def entry_call(name: str) -> Call:
    """The kernel of an entry, and the types of its arguments."""
    return kernels()[name], tuple(map(declared_type, ENTRIES[name].split()))


@functools.cache
def initialise() -> None:
    """Make LLVM ready for all platforms."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()


def _entry(module: ir.Module, name: str, call: Call, returned: Any) -> None:
    """Add the C function of an entry to the module; see `..library`."""
    context = cpu_target.target_context
    args = call[1]
    kinds = ENTRIES[name].split() if name in ENTRIES else [""] * len(args)
    numbers = [_FLOAT if a == types.float64 else _INT for a in args if not isinstance(a, _POINTED)]
    function = ir.Function(module, ir.FunctionType(_INT, [_INT.as_pointer(), *numbers]), c_name(name))
    builder = ir.IRBuilder(function.append_basic_block())
    words, *given = function.args
    place = 0

    def word() -> Any:
        nonlocal place
        place += 1
        return builder.load(builder.gep(words, [ir.Constant(_INT, place - 1)]))

    values = []
    for kind, declared in zip(args, kinds, strict=True):
        if not isinstance(kind, _POINTED):
            value = given.pop(0)
            values.append(builder.icmp_signed("!=", value, ir.Constant(_INT, 0)) if kind == types.boolean else value)
            continue
        data = word()
        if isinstance(kind, types.Record):
            values.append(builder.inttoptr(data, context.get_value_type(kind)))
            continue
        lengths = [ir.Constant(_INT, 0)] if declared.endswith("}") else [word() for _ in range(kind.ndim)]
        size = ir.Constant(_INT, context.get_abi_sizeof(context.get_data_type(kind.dtype)))
        strides, items = [size], lengths[-1]
        for n in reversed(lengths[1:]):
            strides.insert(0, builder.mul(strides[0], n))
        for n in lengths[:-1]:
            items = builder.mul(items, n)
        array = context.make_array(kind)(context, builder)
        context.populate_array(
            array,
            data=builder.inttoptr(data, context.get_data_type(kind.dtype).as_pointer()),
            shape=cgutils.pack_array(builder, lengths),
            strides=cgutils.pack_array(builder, strides),
            itemsize=size,
            meminfo=None,
        )
        values.append(array._getvalue())
    convention = context.call_conv
    kernel = ir.Function(module, convention.get_function_type(returned, args), calls.symbol(call))
    status, result = convention.call_function(builder, kernel, returned, args, values)
    with cgutils.if_unlikely(builder, status.is_error):
        full = builder.icmp_signed("==", status.code, ir.Constant(status.code.type, 1 + parts.MEMORY_STATUS))
        builder.ret(builder.select(full, ir.Constant(_INT, NO_MEMORY), ir.Constant(_INT, NO_SHAPE)))
    if returned == types.none:
        builder.ret(ir.Constant(_INT, 0))
    else:
        builder.ret(result if result.type == _INT else builder.zext(result, _INT))


@dataclass(frozen=True)
class Group:
    """The content of one module.

    Attributes:
        entries: (name, returned type) of its entry points.
        parts: the code of its kernels, in an order that does not vary.
        public: symbols of its kernels that other modules call.
        foreign: symbols that it calls of other modules.
    """

    entries: list[tuple[str, Any]]
    parts: list[bytes]
    public: frozenset[str] = frozenset()
    foreign: frozenset[str] = frozenset()


def linked(group: Group, calls: Mapping[str, Call] | None = None) -> Any:
    """One module of the C functions of the entries, the parts and the runtime, optimised for no platform yet. `calls`:
    of entries that `entries.py` does not list.

    Raises:
        RuntimeError: the parts call a function that is missing.
    """
    initialise()
    parts.adapt()
    module = ir.Module("eeca_kernels")
    context = cpu_target.target_context
    module.triple, module.data_layout = llvm.get_process_triple(), context.codegen()._data_layout
    for name, returned in group.entries:
        _entry(module, name, (calls or {}).get(name) or entry_call(name), returned)
    whole = llvm.parse_assembly(cgutils.normalize_ir_text(str(module)))
    runtime = Path(__file__).with_name("runtime.ll").read_text(encoding="utf-8")
    header = f'target triple = "{module.triple}"\ntarget datalayout = "{module.data_layout}"\n'
    whole.link_in(llvm.parse_assembly(header + runtime))
    for one in group.parts:
        whole.link_in(llvm.parse_bitcode(one))
    seen = {c_name(name) for name, _ in group.entries}
    for one in (*whole.functions, *whole.global_variables):
        if not one.is_declaration and one.name not in seen:
            if one.name in group.public:
                one.visibility = "hidden"
            else:
                one.linkage = "internal"
    _check_complete(whole, group.foreign)
    return whole


def retargeted(module: Any, machine: Any) -> Any:
    """A copy of a module for another platform, whose entry points are exported."""
    copy = module.clone()
    copy.triple, copy.data_layout = machine.triple, str(machine.target_data)
    if "windows" in machine.triple:
        for one in (*copy.functions, *copy.global_variables):
            if not one.is_declaration and one.name.startswith("eeca_"):
                one.storage_class = "dllexport"
    return copy


def _check_complete(module: Any, foreign: frozenset[str]) -> None:
    lacking = {f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")}
    if missing := sorted(lacking - C_LIBRARY - foreign):
        raise RuntimeError(
            f"kernels need {', '.join(missing)}, which no part has: lists, strings, sorting and assignments of arrays "
            "to slices are not compiled"
        )


def optimise(module: Any, machine: Any) -> None:
    """Inline, simplify and vectorise; pairs of reference counts up and down are removed."""
    tuning = llvm.create_pipeline_tuning_options(LEVEL)
    tuning.loop_vectorization, tuning.slp_vectorization = True, False
    builder = llvm.create_pass_builder(machine, tuning)
    passes = builder.getModulePassManager()
    passes.add_refprune_pass()
    passes.run(module, builder)


def object_of(group: Group, triple: str, cpu: str) -> bytes:
    """Machine code of a group for a platform, as an object file."""
    machine = machine_of(triple, cpu)
    module = retargeted(linked(group), machine)
    optimise(module, machine)
    return bytes(machine.emit_object(module))


def marked_object(sources: str, triple: str, cpu: str) -> bytes:
    """An object file that contains only the hash of the sources, as the symbol `eeca_sources`."""
    machine = machine_of(triple, cpu)
    module = llvm.parse_assembly(f'@eeca_sources = constant [{len(sources)} x i8] c"{sources}"\n')
    return bytes(machine.emit_object(retargeted(module, machine)))


def host() -> str:
    """The name of this processor."""
    initialise()
    return str(llvm.get_host_cpu_name())


def host_object_of(group: Group) -> bytes:
    """Machine code of a group for this processor, to be loaded into a process."""
    machine = machine_of(llvm.get_process_triple(), host(), here=True)
    module = linked(group)
    optimise(module, machine)
    return bytes(machine.emit_object(module))


def machine_of(triple: str, cpu: str, here: bool = False) -> Any:
    """LLVM's description of a processor; `here`: for code that runs in this process, wherever the C library is."""
    initialise()
    target = llvm.Target.from_triple(triple)
    reloc, model = ("default", "jitdefault") if here else ("pic", "default")
    return target.create_target_machine(cpu=cpu, opt=LEVEL, reloc=reloc, codemodel=model)
