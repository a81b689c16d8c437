"""warmup: have machine code of all kernels now, not at the first steps."""

from __future__ import annotations

import time

from .compiled.entries import ENTRIES
from .compiled.kernels import kernels, prepare


def warmup() -> float:
    """Load the library of kernels now, and build it if it is missing; seconds that took.

    Without it that happens at the first step. Installed packages bring their library, which loads in milliseconds; a
    clone builds it once for every edit of its kernels (`python -m eeca_pymunk.build`), which takes up to two minutes.
    Where kernels are compiled just in time (EECA_KERNELS=jit), all of them are compiled here. `python -m eeca_pymunk`
    says which of these runs. Nothing that the caller holds is touched.

        python -c "import eeca_pymunk as ep; print(ep.warmup())"
    """
    start = time.perf_counter()
    if prepare().kind == "jit":
        from .compiled.frontend.jit import ready

        for name in ENTRIES:
            ready(kernels()[name])
    return time.perf_counter() - start
