"""numba as a compiler of kernels, and LLVM: all that this package uses of their private names.

In: kernels and the types of their arguments. Out: LLVM code of each kernel (`parts.py`, kept in `store.py`), one module
of all that the entry points reach (`module.py`), and that module as code of this process (`jit.py`). Open `calls.py`
first: it types and lowers calls between kernels. `types.py` has the types of tables and what else kernels name.

`NUMBA` is the version whose private names these files know: how it stores code, reports errors and lays out arrays.
"""

NUMBA = "0.68"
