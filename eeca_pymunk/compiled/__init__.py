"""Kernels: functions of arrays and numbers that run as machine code.

In: Python functions with one of the decorators `kernel`, `uncounted`, `merged`. Out: the same functions, called from
Python as machine code of a library built ahead of time, as code that numba compiles, or as plain Python.

Open first `backend.py`: it chooses among the three. `entries.py` declares which kernels Python calls, `library.py` loads
the library, `tables.py` passes many arrays as one pointer. Nothing here imports numba; `eeca_pymunk/build` does.
"""

from .kernels import Kernel, kernel, merged, uncounted
from .prefetch import fetch
from .tables import Opener, Table, table_of

__all__ = ["Kernel", "Opener", "Table", "fetch", "kernel", "merged", "table_of", "uncounted"]
