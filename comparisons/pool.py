"""Many cases on several processes: what `--workers` asks for."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TypeVar

import eeca_pymunk as ep

Case = TypeVar("Case")
Result = TypeVar("Result")


def over(function: Callable[[Case], Result], cases: Sequence[Case], workers: int) -> list[Result]:
    """The results of all cases, in order, from so many processes, with a progress bar."""
    if workers == 1:
        return ep.sweep(function, cases, progress=True)
    # Once, here: else every process compiles for itself.
    ep.warmup()
    with ProcessPoolExecutor(workers, get_context("spawn"), _silence) as executor:
        return ep.sweep(function, cases, executor, progress=True)


def _silence() -> None:
    # One progress bar is enough, and it is the parent's. What goes wrong comes back as an exception.
    sys.stderr = open(os.devnull, "w")  # noqa: SIM115 - for as long as the process lives
