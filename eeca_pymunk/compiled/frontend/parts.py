"""LLVM code of one kernel: a part.

numba types and lowers the kernel; functions that numba adds become private to the part. The only public symbol of a
part is `calls.symbol`; it refers to other parts, to the runtime (`runtime.ll`) and to the C library.

numba is adapted in the processes of the builder, which do nothing else:

* numba makes no machine code of a part: the code remains LLVM code;
* an error is a status without a Python exception, so that no path of a source file enters the code;
* an index counts from the start of an array: numba's test for negative indices takes three instructions at every
  access, a fifth of all in linear algebra;
* the types of operators are looked up once, which saves a sixth of the time of typing.
"""

from __future__ import annotations

import functools
import gc
import math
import operator
import time
from typing import Any

import llvmlite.binding as llvm
import numba
from llvmlite import ir
from numba.core import callconv, codegen, types
from numba.core.registry import cpu_target
from numba.core.runtime import rtsys  # type: ignore[attr-defined]
from numba.np import arrayobj

from ..kernels import set_types
from . import NUMBA, calls
from .calls import Call, annotated, by_symbol, symbol

_OPTIONS = {
    "fastmath": False, "error_model": "numpy", "boundscheck": False, "nogil": True, "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}  # fmt: skip
# Statuses of kernels, added to numba's own; those of entries are in `library.py`.
MEMORY_STATUS, SHAPE_STATUS = 1, 2


class Part:
    """The code of a kernel as bitcode, its calls of other kernels, its return type, and the seconds of its
    compilation."""

    def __init__(self, bitcode: bytes, calls: list[Call], returned: Any, seconds: float) -> None:
        self.bitcode, self.calls, self.returned, self.seconds = bitcode, calls, returned, seconds


class _Quiet:
    """numba's code generator, whose `set_env` does nothing, because parts have no environment."""

    def __init__(self, real: Any) -> None:
        self._real = real

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)

    def set_env(self, name: str, environment: Any) -> None:
        """A part has no environment."""


class _Library(codegen.JITCodeLibrary):
    """LLVM code as numba's front end leaves it, not compiled further."""

    codegen = property(lambda self: _Quiet(self._codegen))

    def finalize(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0


def _raise(self: Any, builder: Any, exc: Any, *_: Any, **__: Any) -> None:
    """In the place of numba's `return_user_exc`: return a status, without the exception."""
    code = MEMORY_STATUS if exc is not None and issubclass(exc, MemoryError) else SHAPE_STATUS
    self.check_try_status(builder)
    self._return_errcode_raw(builder, ir.Constant(callconv.errcode_t, callconv.RETCODE_USEREXC.constant + code))


def _index(context: Any, builder: Any, kind: Any, index: Any, size: Any) -> Any:
    """In the place of numba's `fix_integer_index`: only constant indices may be negative."""
    if isinstance(index, ir.Constant):
        return _usual_index(context, builder, kind, index, size)
    return context.cast(builder, index, kind, types.intp if kind.signed else types.uintp)


_usual_index: Any = arrayobj.fix_integer_index


def _remember_operators(context: Any) -> None:
    known = {*filter(callable, vars(operator).values()), *filter(callable, vars(math).values())}
    known |= {min, max, abs, int, float, bool, range, len}
    usual, answers = context.resolve_function_type, {}

    def resolve(function: Any, args: Any, kws: Any) -> Any:
        key = function.typing_key if isinstance(function, types.Function) else function
        if kws or getattr(key, "__hash__", None) is None or key not in known:
            return usual(function, args, kws)
        if (key, args := tuple(args)) not in answers:
            answers[key, args] = usual(function, args, kws)
        return answers[key, args]

    context.resolve_function_type = resolve


@functools.cache
def adapt() -> None:
    """Make numba in this process a compiler of parts.

    Raises:
        ImportError: numba is not of the version that this file knows.
    """
    if not numba.__version__.startswith(f"{NUMBA}."):
        raise ImportError(
            f"numba {numba.__version__} is installed; kernels are compiled by {NUMBA}: pip install 'numba=={NUMBA}.*'"
        )
    # Compiling makes much that lives long: collecting garbage would take a sixth of the time.
    gc.set_threshold(100_000, 50, 50)
    rtsys.initialize(cpu_target.target_context)
    cpu_target.target_context.codegen()._library_class = _Library
    convention: Any = callconv.CPUCallConv
    convention.return_user_exc = convention.return_dynamic_user_exc = _raise
    arrayobj.fix_integer_index = _index
    _remember_operators(cpu_target.typing_context)
    set_types(calls.type_of)
    calls.inferred.append(lambda call: part_of(call).returned)


@functools.cache
def part_of(call: Call) -> Part:
    """Compile a kernel for these types of arguments, once in a process."""
    adapt()
    start = time.perf_counter()
    kernel, args = call
    returned = annotated(kernel)
    options: dict[str, Any] = _OPTIONS if kernel.counted else _OPTIONS | {"_nrt": False}
    dispatcher: Any = numba.njit(**options)(kernel.python)
    dispatcher.compile(args if returned is None else returned(*args))
    found = dispatcher.overloads[args]
    module = _module(found, symbol(call), kernel.inlined)
    made = [by_symbol[f.name] for f in module.functions if f.is_declaration and f.name in by_symbol]
    return Part(bytes(module.as_bitcode()), made, found.signature.return_type, time.perf_counter() - start)


def _module(found: Any, name: str, inlined: bool) -> Any:
    """The code of a compiled kernel and of numba's functions that it calls, with `name` as its public symbol."""
    libraries, waiting = {}, [found.library]
    while waiting:
        one = waiting.pop()
        if id(one) not in libraries and one is not rtsys.library:
            libraries[id(one)] = one
            waiting += one._linking_libraries
    whole = found.library._final_module.clone()
    for one in libraries.values():
        if one is not found.library:
            whole.link_in(one._final_module, preserve=True)
    own = whole.get_function(found.fndesc.llvm_func_name)
    own.name = name
    if inlined:
        # Not by numba's option, which functions of numba compiled meanwhile would inherit.
        own.add_function_attribute("alwaysinline")
    _hide(whole, name)
    passes, builder = _cleaning()
    passes.run(whole, builder)
    # numba numbers its functions in their names, which therefore depend on the process and on the order.
    _hide(whole, name)
    whole.name = name
    return whole


def _hide(module: Any, name: str) -> None:
    """Make all but this symbol private, and number their names."""
    for kind, all_of in (("f", module.functions), ("g", module.global_variables)):
        there = [one for one in all_of if not one.is_declaration and one.name != name]
        for number, one in enumerate(there):
            one.linkage, one.name = "internal", f"{name}.{kind}{number}"


@functools.cache
def _cleaning() -> Any:
    """Passes that remove functions that are not called, such as numba's wrappers for Python, and names of values."""
    machine = llvm.Target.from_default_triple().create_target_machine()
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_strip_symbols_pass()
    return passes, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options())
