"""Kernels: functions of arrays and numbers that run as machine code.

In: Python functions with one of three decorators (`kernels.py`): `kernel`; `nonallocating`, for kernels that create no
arrays, which is faster; `inlined`, for small ones that are inlined. Out: the same functions, run as machine code of a
library built ahead of time, as code compiled just in time, or as plain Python.

Open first `backend.py`, which chooses among the three. `entries.py` declares the kernels that Python calls,
`library.py` loads the library, `tables.py` passes many arrays as one pointer, `layouts.py` has their memory.
`frontend/` compiles a single kernel, and `..build` runs it for all kernels in parallel and links. Only the modules of
`frontend/` import numba; builds and the JIT import them, other processes only read the version number there.
"""

from .backend import start
from .kernels import Choice, Kernel, fetch, inlined, kernel, nonallocating, prepare
from .tables import Opener, Table, replaced, table_of

__all__ = [
    "Choice",
    "Kernel",
    "Opener",
    "Table",
    "fetch",
    "inlined",
    "kernel",
    "nonallocating",
    "plain",
    "prepare",
    "replaced",
    "start",
    "table_of",
]


def plain() -> bool:
    """Whether kernels run as plain Python."""
    return start().kind == "python"
