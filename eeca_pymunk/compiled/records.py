"""Records: rows of named 64-bit numbers, as kernels and as numpy see them."""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar, overload

import numpy as np

from ..arrays import AnyArray

if TYPE_CHECKING:
    _Row = object
else:
    _Row = np.void

KINDS: dict[str, np.dtype[Any]] = {}  # dtypes of all records by name
_CODES = {"float": np.float64, "int": np.int64}


class Record(_Row):
    """One row of an array of records: a view, through which the array is read and written.

    Subclasses annotate their fields as `float` or `int`, in the order in which they lie in memory.

    Attributes:
        TYPE: the dtype of arrays of this record.
    """

    TYPE: ClassVar[np.dtype[Any]]

    def __init_subclass__(cls) -> None:
        fields = [(name, _CODES[kind]) for name, kind in cls.__annotations__.items()]
        cls.TYPE = np.dtype((cls, np.dtype(fields, align=True)))
        KINDS[cls.__name__] = cls.TYPE
        for name, _ in fields:
            setattr(cls, name, property(itemgetter(name), _setter(name)))

    def __reduce__(self) -> tuple[Any, ...]:
        # numpy's copies of a row cannot be written to.
        return _row_of, (type(self), self.tobytes())

    def __deepcopy__(self, memo: Any = None) -> Any:
        return _row_of(type(self), self.tobytes())

    __copy__ = __deepcopy__


def _setter(name: str) -> Any:
    def put(row: Any, value: float) -> None:
        row[name] = value

    return put


R = TypeVar("R", bound=Record)


def _row_of(kind: type[R], content: bytes) -> R:
    return np.frombuffer(bytearray(content), kind.TYPE)[0]  # type: ignore[no-any-return]


if TYPE_CHECKING:

    class Rows(Generic[R]):
        """An array of records: `rows[i].field` is a number, `rows["field"]` a column."""

        shape: tuple[int, ...]
        dtype: np.dtype[Any]

        def __len__(self) -> int: ...
        @overload
        def __getitem__(self, at: int) -> R: ...
        @overload
        def __getitem__(self, at: str) -> AnyArray: ...
        @overload
        def __getitem__(self, at: slice | AnyArray) -> Rows[R]: ...
        def __getitem__(self, at: Any) -> Any: ...
        def __setitem__(self, at: Any, value: Any) -> None: ...
        def copy(self) -> Rows[R]: ...
        def view(self, kind: Any) -> AnyArray: ...

else:

    class Rows(Generic[R]):
        """An array of records, as annotations name it; it is a numpy array."""


def rows(kind: type[R], count: int) -> Rows[R]:
    """(count,) records of zeros."""
    return np.zeros(count, kind.TYPE)  # type: ignore[return-value]


def row(kind: type[R]) -> R:
    """One record of zeros."""
    return np.zeros(1, kind.TYPE)[0]  # type: ignore[no-any-return]


def table(of: Rows[Any]) -> AnyArray:
    """(rows, fields) the numbers of records whose fields are all floats, or all integers: a view."""
    kind = of.dtype.fields[of.dtype.names[0]][0]  # type: ignore[index]
    return of.view(kind).reshape(len(of), -1)
