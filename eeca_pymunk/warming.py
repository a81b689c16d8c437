"""warmup: have machine code of all kernels now, not at the first steps."""

from __future__ import annotations

import time

from .compiled import prepare


def warmup() -> float:
    """Load the library of kernels now, and build it if it is missing; seconds that took.

    Without it that happens at the first step. Installed packages bring their library, which loads in milliseconds; a
    clone builds it once for every edit of its kernels (`python -m eeca_pymunk.build`), which takes up to two minutes.
    `python -m eeca_pymunk` says which code runs. Nothing that the caller holds is touched.

        python -c "import eeca_pymunk as ep; print(ep.warmup())"
    """
    start = time.perf_counter()
    prepare()
    return time.perf_counter() - start
