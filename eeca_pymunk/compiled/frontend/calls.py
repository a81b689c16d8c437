"""Calls between kernels, typed by annotations.

numba compiles a callee before it can type the call. Here a call is typed by the annotated return type of the kernel,
and lowered to a call of a symbol. So each kernel is compiled by itself, in any order and in any process, and once for
each tuple of argument types. Literals and 32-bit integers count as 64-bit numbers, so that constants in a call do not
make another tuple.
"""

from __future__ import annotations

import functools
import hashlib
import inspect
import typing
from collections.abc import Callable
from typing import Any

from numba.core import cgutils, types

from ..kernels import Choice, Compilable, Kernel
from .types import global_type, type_of_other

_RETURNED = {int: types.int64, float: types.float64, bool: types.boolean, type(None): types.none}

Call = tuple[Kernel[Any, Any], tuple[Any, ...]]  # a kernel and the types of its arguments
by_symbol: dict[str, Call] = {}  # all calls that have been typed
# Function that compiles a kernel to find its return type if the annotation does not give it (an array, for instance);
# set by `parts.adapt`.
inferred: list[Callable[[Call], Any]] = []


def symbol(call: Call) -> str:
    """The symbol of a kernel's code for these types of arguments."""
    kernel, args = call
    digest = hashlib.sha256(f"{kernel.name}{args!r}".encode()).hexdigest()
    return f"{kernel.python.__name__}_{digest[:16]}"


@functools.cache
def annotated(kernel: Kernel[Any, Any]) -> Any:
    """numba's type of the annotated return type of a kernel; None if the annotation leaves it open."""
    return _returned(typing.get_type_hints(kernel.python)["return"])


def _returned(hint: Any) -> Any:
    if typing.get_origin(hint) is tuple:
        parts = [_returned(one) for one in typing.get_args(hint)]
        return None if None in parts else types.Tuple(parts)
    return _RETURNED.get(hint) if isinstance(hint, type) else None


def _wide(kind: Any) -> Any:
    kind = types.unliteral(kind)
    return types.int64 if kind == types.int32 else kind


def typed_call(kernel: Kernel[Any, Any], args: tuple[Any, ...]) -> tuple[Any, Callable[..., Any]]:
    """The signature of a call, and the function that lowers it."""
    call = kernel, tuple(map(_wide, args))
    returned = annotated(kernel)
    if returned is None:
        returned = inferred[-1](call)
    name = symbol(call)
    by_symbol[name] = call

    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        convention = context.call_conv
        kind = convention.get_function_type(signature.return_type, signature.args)
        function = cgutils.get_or_insert_function(builder.module, kind, name)
        status, result = convention.call_function(builder, function, signature.return_type, signature.args, values)
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return result

    return returned(*call[1]), lower


@functools.cache
def type_of(one: Compilable) -> Any:
    """numba's type of a kernel, an opener or `fetch`."""
    if not isinstance(one, Kernel | Choice):
        return type_of_other(one)
    # numba takes the number and names of arguments from a function.
    python = one.python if isinstance(one, Kernel) else one.kernels[0].python
    parameters = list(inspect.signature(python).parameters)
    names = ", ".join(parameters)
    chosen = (lambda _: one) if isinstance(one, Kernel) else (lambda kind: one.of[kind.instance_class])
    scope: dict[str, Any] = {"typed_call": typed_call, "kernel_for_": chosen}
    exec(
        f"def {python.__name__}(typing, {names}):\n    return typed_call(kernel_for_({parameters[0]}), ({names},))",
        scope,
    )
    return global_type(scope[python.__name__])
