"""Indices of kernels as they stand: from the start of an array, never from its end.

numba asks at every access whether an index is negative, and adds the length if so: three instructions, in loops of
linear algebra a fifth of them all. No kernel of this package counts from the end but by a constant, `A[-1]`, which
keeps its meaning. Code of others is compiled as ever; and where numba is not as known, so is ours.
"""

from __future__ import annotations

import functools
import inspect
from typing import Any

_MINE = __name__.partition(".")[0]
_KNOWN = ["context", "builder", "idxty", "idx", "size"]


@functools.cache
def count_from_the_start() -> bool:
    """Let numba take indices of this package's kernels as they are; whether it does."""
    try:
        from llvmlite import ir
        from numba.core import types
        from numba.np import arrayobj

        usual: Any = arrayobj.fix_integer_index
        known = list(inspect.signature(usual).parameters) == _KNOWN
    except (ImportError, AttributeError):
        return False
    if not known:
        return False

    @functools.wraps(usual)
    def index(context: Any, builder: Any, idxty: Any, idx: Any, size: Any) -> Any:
        if isinstance(idx, ir.Constant) or f"{len(_MINE)}{_MINE}" not in builder.function.name:
            return usual(context, builder, idxty, idx, size)
        return context.cast(builder, idx, idxty, types.intp if idxty.signed else types.uintp)

    arrayobj.fix_integer_index = index
    return True
