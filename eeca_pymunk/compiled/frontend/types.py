"""numba's types of tables, openers and `fetch`, and of the arguments that `entries.py` declares.

A table is a pointer to words of 64 bits, WORDS for each array: address of its data, size, its last two lengths. The
words are constant while a kernel runs and are loaded as invariant, so that LLVM reads each word once.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import impl_ret_borrowed, lower_getattr_generic
from numba.core.registry import cpu_target
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, models, register_model
from numba.np.numpy_support import from_dtype

from ..entries import dtype_of, is_array, table_fields
from ..kernels import Compilable, Fetch
from ..tables import WORDS, Opener


class TableType(types.Type):
    """The type of an opened table: a pointer; `arrays` are the (name, dtype, dimensions) of its arrays."""

    def __init__(self, kind: str, arrays: tuple[tuple[str, Any, int], ...]) -> None:
        self.arrays = arrays
        super().__init__(f"{kind}{arrays}")

    def array(self, name: str) -> tuple[int, Any]:
        """Place and type of an array or a record; (-1, None) if there is none of that name."""
        for place, (field, dtype, dimensions) in enumerate(self.arrays):
            if field == name:
                kind = from_dtype(dtype)
                return place, types.Array(kind, dimensions, "C") if dimensions else kind
        return -1, None


@register_model(TableType)
class _Model(models.OpaqueModel):
    """A pointer without a count of references."""


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

    if isinstance(kind, types.Record):
        return builder.inttoptr(read(0), context.get_value_type(kind))
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


def declared_type(kind: str) -> Any:
    """numba's type of `f8[2]`, `i8`, `bool` and the like of `entries.py`; of a table, that of its words."""
    if kind.endswith("}"):
        return types.Array(types.int64, 1, "C")
    if is_array(kind):
        dtype, ndim = dtype_of(kind)
        return types.Array(from_dtype(dtype), ndim, "C") if ndim else from_dtype(dtype)
    return {"f8": types.float64, "i8": types.int64, "bool": types.boolean}[kind]


def global_type(python: Any) -> Any:
    """The type of an intrinsic function, as of a global of a kernel."""
    found = intrinsic(python)
    for context in (cpu_target.typing_context, cpu_target.target_context):
        context.refresh()
    return cpu_target.typing_context.resolve_value_type(found)


def type_of_other(one: Compilable) -> Any:
    """The type of `fetch`, or of an opener, which returns arguments other than tables unchanged."""
    if isinstance(one, Fetch):
        return global_type(_fetch)
    assert isinstance(one, Opener)
    name = one.kind.__name__
    fields = table_fields(name)

    def opened(typing: Any, table: Any) -> Any:
        if not isinstance(table, types.Array):
            return table(table), lambda context, builder, signature, args: impl_ret_borrowed(
                context, builder, signature.return_type, args[0]
            )

        def point(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            numbers = context.make_array(signature.args[0])(context, builder, args[0])
            return builder.bitcast(numbers.data, context.get_value_type(signature.return_type))

        return TableType(name, fields)(table), point

    return global_type(opened)


def _fetch(typing: Any, table: Any, row: Any, column: Any) -> Any:
    """LLVM's prefetch of the cache line of an element."""

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
        if isinstance(signature.args[0].dtype, types.Record):
            line = builder.gep(line, [builder.mul(column, ir.Constant(column.type, 8))])
        kind = ir.FunctionType(ir.VoidType(), [line.type, number, number, number])
        ask = builder.module.declare_intrinsic("llvm.prefetch", [line.type], kind)
        # For reading, to be kept in all caches, data.
        builder.call(ask, [line, ir.Constant(number, 0), ir.Constant(number, 3), ir.Constant(number, 1)])
        return context.get_dummy_value()

    return types.void(table, row, column), bring
