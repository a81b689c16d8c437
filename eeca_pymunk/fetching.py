"""Rows asked for before they are needed.

Crowds do not fit into a processor's caches, and what happens next is somewhere else: a kernel that knows where may have
the memory bring it while it works on what is now. No number depends on it.
"""

from __future__ import annotations

import functools
from typing import Any

from .arrays import AnyArray


class Fetch:
    """`fetch(TABLE, row, column)`: have the cache line brought in which this element of a (rows, columns) or (rows,)
    array is. Nothing happens if there is none, or if kernels run as plain Python."""

    def __call__(self, table: AnyArray, row: int, column: int) -> None:
        """Plain Python waits all the same."""

    @property
    def _numba_type_(self) -> Any:
        # What numba asks a global of a kernel for.
        return _compiled()


@functools.cache
def _compiled() -> Any:
    from llvmlite import ir
    from numba.core import types
    from numba.core.registry import cpu_target
    from numba.extending import intrinsic

    @intrinsic
    def fetch(typing: Any, table: Any, row: Any, column: Any) -> Any:
        def bring(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            array = context.make_array(signature.args[0])(context, builder, args[0])
            number = ir.IntType(32)
            place, column = (
                context.cast(builder, a, k, types.int64) for a, k in zip(args[1:], signature.args[1:], strict=True)
            )
            if signature.args[0].ndim == 2:
                width = builder.extract_value(array.shape, 1)
                place = builder.add(builder.mul(place, width), column)
            line = builder.bitcast(builder.gep(array.data, [place]), ir.IntType(8).as_pointer())
            kind = ir.FunctionType(ir.VoidType(), [line.type, number, number, number])
            ask = builder.module.declare_intrinsic("llvm.prefetch", [line.type], kind)
            # To read, to be kept in all caches, data.
            builder.call(ask, [line, ir.Constant(number, 0), ir.Constant(number, 3), ir.Constant(number, 1)])
            return context.get_dummy_value()

        return types.void(table, row, column), bring

    for context in (cpu_target.typing_context, cpu_target.target_context):
        context.refresh()
    return cpu_target.typing_context.resolve_value_type(fetch)


fetch = Fetch()
