"""warmup: load or build the machine code of all kernels now, not at the first step."""

from __future__ import annotations

import time

from .compiled import prepare


def warmup() -> float:
    """Load the library of kernels now, and build it if it is missing. Returns the seconds that it took.

    Otherwise this happens at the first step. Installed packages contain their library, which loads in milliseconds; a
    clone builds it after every edit of a kernel (`python -m eeca_pymunk.build`), which takes up to two minutes.
    `python -m eeca_pymunk` prints which code runs. No object of the caller is changed.

        python -c "import eeca_pymunk as ep; print(ep.warmup())"
    """
    start = time.perf_counter()
    prepare()
    return time.perf_counter() - start
