"""Kernels: functions of arrays and numbers that run as machine code.

In: Python functions with one of the decorators `kernel`, `uncounted`, `merged`. Out: the same functions, called from
Python as machine code of a library built ahead of time, as code compiled just in time, or as plain Python.

Open first `backend.py`: it chooses among the three. `entries.py` declares which kernels Python calls, `library.py`
loads the library, `tables.py` passes many arrays as one pointer. `frontend/` has the compiler and is imported by
builds and the JIT alone; nothing else imports numba.
"""

from .backend import start
from .kernels import Choice, Kernel, kernel, merged, prepare, uncounted
from .prefetch import fetch
from .tables import Opener, Table, table_of

__all__ = [
    "Choice",
    "Kernel",
    "Opener",
    "Table",
    "fetch",
    "kernel",
    "merged",
    "plain",
    "prepare",
    "start",
    "table_of",
    "uncounted",
]


def plain() -> bool:
    """Whether kernels run as plain Python."""
    return start().kind == "python"
