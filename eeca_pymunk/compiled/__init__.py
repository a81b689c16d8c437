"""Kernels: functions of arrays and numbers that run as machine code.

In: Python functions with one of three decorators (`kernels.py`): `kernel`; `nonallocating`, for kernels that create no
arrays, which is faster; `inlined`, for small ones that are inlined. Out: the same functions, run as machine code of a
library built ahead of time, as code compiled just in time, or as plain Python.

Open first `backend.py`, which chooses among the three. `entries.py` declares the kernels that Python calls,
`library.py` loads the library, `tables.py` passes many arrays as one pointer, `layouts.py` has their memory.
`frontend/` compiles a single kernel, and `..build` runs it for all kernels in parallel and links. Only the modules of
`frontend/` import numba; builds and the JIT import them, other processes only read the version number there.
"""

import time

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
    "warmup",
]


def plain() -> bool:
    """Whether kernels run as plain Python."""
    return start().kind == "python"


def warmup() -> float:
    """Load the library of kernels now, and build it if it is missing. Returns the seconds that it took.

    Otherwise this happens at the first step. Installed packages contain their library, which loads in milliseconds; a
    clone builds it after every edit of a kernel (`python -m eeca_pymunk.build`), which takes up to two minutes.
    `python -m eeca_pymunk` prints which code runs. No object of the caller is changed.

        python -c "import eeca_pymunk as ep; print(ep.warmup())"
    """
    begun = time.perf_counter()
    prepare()
    return time.perf_counter() - begun
