"""Records: rows of named 64-bit numbers, as kernels and as numpy see them."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from operator import itemgetter
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Generic, TypeVar, get_origin, get_type_hints, overload

import numpy as np

from ..arrays import AnyArray, FloatArray, IntArray

if TYPE_CHECKING:

    class _Row:
        def tobytes(self) -> bytes:
            """The memory of the row."""
            return b""

else:
    _Row = np.void

RECORD_TYPES: dict[str, np.dtype[Any]] = {}  # dtypes of all records by name
_CODES: dict[Any, Any] = {float: np.float64, int: np.int64, FloatArray: np.float64, IntArray: np.int64}


class Record(_Row):
    """One row of an array of records: a view, through which the array is read and written.

    Subclasses annotate their fields as `float` or `int`, in the order in which they lie in memory; as
    `Annotated[FloatArray, 2, 6]` what is an array of this shape within the row.

    Attributes:
        TYPE: the dtype of arrays of this record.
    """

    TYPE: ClassVar[np.dtype[Any]]

    def __init_subclass__(cls) -> None:
        hints = get_type_hints(cls, include_extras=True)
        fields = [(name, *_code(hints[name])) for name in cls.__annotations__]
        cls.TYPE = np.dtype((cls, np.dtype(fields, align=True)))
        RECORD_TYPES[cls.__name__] = cls.TYPE
        for name, *_ in fields:
            setattr(cls, name, property(itemgetter(name), _setter(name)))

    def __reduce__(self) -> tuple[Any, ...]:
        # A pickled or copied `numpy.void` is read-only.
        return _row_of, (type(self), self.tobytes())

    def __deepcopy__(self, memo: Any = None) -> Any:
        return _row_of(type(self), self.tobytes())

    __copy__ = __deepcopy__


def _code(hint: Any) -> tuple[Any, tuple[int, ...]]:
    """The numpy type and the shape of a field."""
    if get_origin(hint) is Annotated:
        return _CODES[hint.__origin__], hint.__metadata__
    return _CODES[hint], ()


def _setter(name: str) -> Any:
    def put(row: Any, value: float) -> None:
        row[name] = value

    return put


R = TypeVar("R", bound=Record)


def _row_of(kind: type[R], content: bytes) -> R:
    return np.frombuffer(bytearray(content), kind.TYPE)[0]  # type: ignore[no-any-return]


if TYPE_CHECKING:

    class Rows(np.ndarray[Any, np.dtype[Any]], Generic[R]):
        """An array of records: `rows[i].field` is a number, `rows["field"]` a column."""

        @overload  # type: ignore[override]
        def __getitem__(self, at: int) -> R: ...
        @overload
        def __getitem__(self, at: str) -> AnyArray: ...
        @overload
        def __getitem__(self, at: slice | AnyArray) -> Rows[R]: ...
        def __getitem__(self, at: Any) -> Any: ...
        def copy(self) -> Rows[R]: ...  # type: ignore[override]

    class Kind(Generic[R]):
        """The dtype of arrays of a record, as kernels name it."""

    def empty(count: int, kind: Kind[R]) -> Rows[R]:
        """(count,) records of any numbers, in a kernel."""

    def zeros(count: int, kind: Kind[R]) -> Rows[R]:
        """(count,) records of zeros, in a kernel."""

else:

    class Rows(Generic[R]):
        """An array of records, as annotations name it; it is a numpy array."""

    # Kernels name numpy's own functions.
    empty, zeros = np.empty, np.zeros


def kind_of(record: type[R]) -> Kind[R]:
    """The dtype of arrays of this record, for kernels."""
    return record.TYPE  # type: ignore[return-value]


def rows(kind: type[R], count: int) -> Rows[R]:
    """(count,) records of zeros."""
    return np.zeros(count, kind.TYPE)  # type: ignore[return-value]


def row(kind: type[R]) -> R:
    """One record of zeros."""
    return np.zeros(1, kind.TYPE)[0]  # type: ignore[no-any-return]


def from_bytes(kind: type[R], content: Sequence[bytes]) -> Rows[R]:
    """(n,) records from the bytes of each."""
    return over(kind, bytearray().join(content))


def over(kind: type[R], memory: bytearray | memoryview) -> Rows[R]:
    """The records in this memory."""
    return np.frombuffer(memory, kind.TYPE)  # type: ignore[return-value]


def packer(kind: type[Record], *unsigned: str) -> struct.Struct:
    """Makes the bytes of a record of its numbers, of which the integers `unsigned` are from 0 to 2^64 - 1."""
    codes = {np.dtype(np.float64): "d", np.dtype(np.int64): "q"}
    return struct.Struct("".join("Q" if n in unsigned else codes[kind.TYPE[n]] for n in kind.TYPE.names or ()))


def as_integers(of: Rows[Any]) -> IntArray:
    """The memory of records: a view. To copy records takes ten times as long."""
    # numpy's `view` looks through all fields.
    return np.ndarray(of.nbytes // 8, np.int64, of)


def selected(kind: type[R], memory: bytearray, rows: Iterable[int]) -> bytearray:
    """The memory of these rows of the records in `memory`; of zeros for rows below 0."""
    size = kind.TYPE.itemsize
    zeros = bytes(size)
    return bytearray().join([memory[row * size : row * size + size] if row >= 0 else zeros for row in rows])


def numbers(of: Record) -> AnyArray:
    """(fields,) the numbers of a record whose fields are all of one kind: a view."""
    one: AnyArray = np.asarray(of)
    return one.reshape(1).view(one.dtype[0])


def columns(of: Rows[Any], *names: str) -> AnyArray:
    """(rows, fields) a copy of some fields of the same kind, by their names."""
    # numpy's `stack` takes three times as long for few rows.
    found = np.empty((*of.shape, len(names)), of.dtype[names[0]])
    for k, name in enumerate(names):
        found[..., k] = of[name]
    return found


def put(into: Rows[Any], values: AnyArray, *names: str) -> None:
    """Set some fields, by their names, from the columns of `values` (rows, fields)."""
    for k, name in enumerate(names):
        into[name] = values[..., k]
