"""Warming up: what a process does once, done before the first step of a program."""

from __future__ import annotations

import time
from functools import cache

from .compiled import plain, prepare
from .eeca import EECA
from .space.small_space import changes, small_space


def warmup() -> float:
    """Load the library of kernels now, build it if it is missing, and step a small space. Returns the seconds that it
    took.

    Otherwise this happens in the first steps. Installed packages contain their library, which loads in milliseconds; a
    clone builds it after every edit of a kernel (`python -m eeca_pymunk.build`), which takes up to two minutes.
    `python -m eeca_pymunk` prints which code runs. The small space takes some ten milliseconds, once: Python runs
    functions faster after some calls, and the library is read from disk where it is used. No object of the caller is
    changed.

        python -c "import eeca_pymunk as ep; print(ep.warmup())"
    """
    begun = time.perf_counter()
    prepare()
    if not plain():
        _step_small_space()
    return time.perf_counter() - begun


@cache
def _step_small_space() -> None:
    space = small_space()
    stepper = EECA(space)
    for _ in changes(space):
        stepper.step(0.01)
