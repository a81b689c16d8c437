"""numba as a compiler of kernels, and LLVM: all uses of their private names are in this room.

In: kernels and the types of their arguments. Out: LLVM code of each kernel (`parts.py`, stored by `store.py`), one
module of all kernels that the entry points call (`module.py`), and that module as code of this process (`jit.py`). Open
`calls.py` first: it types and lowers calls between kernels. `types.py` has the types of tables, openers and `fetch`.

`NUMBA` is the version whose private names these files use.
"""

NUMBA = "0.68"
