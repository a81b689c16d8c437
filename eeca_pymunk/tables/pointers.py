"""What numba has to know of `table.py`. It is imported when kernels are compiled, and only then.

A table is a pointer to words of 64 bits, WORDS for each array: where its data are, its size, its last two lengths.
Nothing of this changes while a kernel runs, which LLVM is told: it reads a word once, however often it is asked for.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import lower_getattr_generic
from numba.core.registry import cpu_target
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, models, register_model
from numba.np.numpy_support import from_dtype

from .table import WORDS, fields


class TableType(types.Type):
    """The type of an opened table: a pointer; `arrays` are the (name, dtype, dimensions) of its arrays."""

    def __init__(self, kind: str, arrays: tuple[tuple[str, str, int], ...]) -> None:
        self.arrays = arrays
        super().__init__(f"{kind}{arrays}")

    def array(self, name: str) -> tuple[int, Any]:
        """Place and type of an array; (-1, None) if there is none of that name."""
        for place, (field, dtype, dimensions) in enumerate(self.arrays):
            if field == name:
                return place, types.Array(from_dtype(np.dtype(dtype)), dimensions, "C")
        return -1, None


@register_model(TableType)
class _Model(models.OpaqueModel):
    """A pointer that nobody counts."""


@infer_getattr
class _Attributes(AttributeTemplate):
    key = TableType

    def generic_resolve(self, table: Any, name: Any) -> Any:  # type: ignore[override]
        return table.array(name)[1]


@lower_getattr_generic(TableType)  # type: ignore[untyped-decorator, no-untyped-call, unused-ignore]
def _attribute(context: Any, builder: Any, table: TableType, value: Any, name: str) -> Any:
    place, kind = table.array(name)
    word = ir.IntType(64)
    words = builder.bitcast(value, word.as_pointer())
    unchanging = builder.module.add_metadata([])

    def read(number: int) -> Any:
        found = builder.load(builder.gep(words, [ir.Constant(word, place * WORDS + number)]))
        found.set_metadata("invariant.load", unchanging)
        return found

    one = context.make_array(kind)(context, builder)
    size = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    lengths = [read(2), read(3)][-min(kind.ndim, 2) :]
    strides = [ir.Constant(word, size)]
    if kind.ndim > 1:
        strides.insert(0, builder.mul(lengths[1], strides[0]))
    if kind.ndim > 2:
        strides.insert(0, builder.mul(lengths[0], strides[0]))
        lengths.insert(0, builder.sdiv(read(1), builder.mul(lengths[0], lengths[1])))
    one.data = builder.inttoptr(read(0), context.get_data_type(kind.dtype).as_pointer())
    one.nitems, one.itemsize = read(1), ir.Constant(word, size)
    one.shape, one.strides = cgutils.pack_array(builder, lengths), cgutils.pack_array(builder, strides)
    one.meminfo, one.parent = cgutils.get_null_value(one.meminfo.type), cgutils.get_null_value(one.parent.type)
    return one._getvalue()


@functools.cache
def opener(kind: str) -> Any:
    """The numba type of the function that opens tables of this kind; what is no table, it hands on as it is."""

    @intrinsic
    def opened(typing: Any, table: Any) -> Any:
        if not isinstance(table, types.Array):
            return table(table), lambda context, builder, signature, args: args[0]

        def point(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            numbers = context.make_array(signature.args[0])(context, builder, args[0])
            return builder.bitcast(numbers.data, context.get_value_type(signature.return_type))

        return TableType(kind, fields[kind])(table), point

    for context in (cpu_target.typing_context, cpu_target.target_context):
        context.refresh()
    return cpu_target.typing_context.resolve_value_type(opened)
