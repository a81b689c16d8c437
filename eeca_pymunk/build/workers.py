"""Parts compiled by several processes."""

from __future__ import annotations

import importlib
import multiprocessing
import os
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from typing import Any

from ..compiled.entries import ENTRIES
from ..compiled.frontend import store
from ..compiled.frontend.calls import Call
from ..compiled.frontend.parts import Part, adapt, part_of
from ..compiled.kernels import kernels

_FEW = 8  # missing parts up to which other processes would take longer to start than to compile


def _start() -> None:
    import_kernels()
    adapt()


def import_kernels() -> None:
    """Import all modules of which Python calls kernels, and with them all kernels."""
    for name in ENTRIES:
        importlib.import_module(f"eeca_pymunk.{name.partition(':')[0]}")


def _compile(name: str, args: tuple[Any, ...]) -> tuple[bytes, list[tuple[str, tuple[Any, ...]]], Any, float]:
    part = part_of((kernels()[name], args))
    return part.bitcode, [(one.name, kinds) for one, kinds in part.calls], part.returned, part.seconds


def gather(first: Iterable[Call], workers: int, told: Callable[[int, int], None]) -> dict[Call, Part]:
    """The parts of these calls and of all that they call, from the store or compiled.

    Args:
        workers: processes.
        told: called with the numbers of parts that are there and that are known to be needed.
    """
    found: dict[Call, Part] = {}
    known: set[Call] = set()
    missing: list[Call] = []
    running: dict[Future[Any], Call] = {}
    pool: ProcessPoolExecutor | None = None
    all_kernels = kernels()

    def look(calls: Iterable[Call]) -> None:
        waiting = list(calls)
        while waiting:
            call = waiting.pop()
            if call in known:
                continue
            known.add(call)
            part = store.read_part(call)
            if part is None:
                missing.append(call)
            else:
                found[call] = part
                waiting += part.calls
        told(len(found), len(known))

    def take(call: Call, part: Part) -> None:
        store.write_part(call, part)
        found[call] = part
        look(part.calls)

    look(first)
    compiled = 0
    try:
        while missing or running:
            if pool is None and (workers < 2 or compiled < _FEW) and len(missing) < _FEW:
                call = missing.pop()
                take(call, part_of(call))
                compiled += 1
                continue
            if pool is None:
                pool = ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"), _start)
            for call in missing:
                running[pool.submit(_compile, call[0].name, call[1])] = call
            missing.clear()
            for done in wait(running, return_when=FIRST_COMPLETED).done:
                bitcode, called, returned, seconds = done.result()
                calls = [(all_kernels[name], args) for name, args in called]
                take(running.pop(done), Part(bitcode, calls, returned, seconds))
    finally:
        if pool is not None:
            pool.shutdown(cancel_futures=True)
    return found


def default_workers() -> int:
    """One process for each core, eight at most."""
    return max(1, min(8, os.cpu_count() or 1))
