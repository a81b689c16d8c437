"""The builder of the library of kernels: `python -m eeca_pymunk.build`.

In: the kernels that `compiled/entries.py` declares. Out: `kernels-HASH-PLATFORM.so` (`.dll`, `.dylib`) beside the
sources. Open first `builder.py`, which has the stages. `workers.py` compiles kernels in several processes, each kernel
by `..compiled.frontend`; `backend.py` has the hooks that pip and `python -m build` call to make wheels.
"""
