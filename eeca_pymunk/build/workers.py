"""Parts compiled by several processes."""

from __future__ import annotations

import importlib
import multiprocessing
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from typing import Any

from ..compiled.entries import ENTRIES
from ..compiled.frontend import store
from ..compiled.frontend.calls import Call
from ..compiled.frontend.module import Group, object_of
from ..compiled.frontend.parts import Part, adapt, part_of
from ..compiled.kernels import kernels
from ..compiled.targets import processors

_FEW = 8  # missing parts up to which other processes would take longer to start than to compile


def _start() -> None:
    import_kernels()
    adapt()


def import_kernels() -> None:
    """Import all modules with entry points, and with them all kernels."""
    for name in ENTRIES:
        importlib.import_module(f"eeca_pymunk.{name.partition(':')[0]}")


def _compile(
    name: str, args: tuple[Any, ...]
) -> tuple[str, bytes, list[tuple[str, tuple[Any, ...]]], Any, float]:  # fmt: skip
    """Compile a part, in a process of the pool. Returns its key and its content, with kernels by name.

    The parent compares the key with its own: they differ if the source was edited in between.
    """
    call = kernels()[name], args
    part = part_of(call)
    calls = [(one.name, kinds) for one, kinds in part.calls]
    return store.part_key(call), part.bitcode, calls, part.returned, part.seconds


class Workers:
    """Processes that compile, started when first needed."""

    def __init__(self, count: int) -> None:
        self.count = count
        self._pool: ProcessPoolExecutor | None = None

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    @property
    def started(self) -> bool:
        return self._pool is not None

    def submit(self, function: Callable[..., Any], *args: Any) -> Future[Any]:
        """Call this function, defined in a module, in one of the processes."""
        if self._pool is None:
            self._pool = ProcessPoolExecutor(self.count, multiprocessing.get_context("spawn"), _start)
        return self._pool.submit(function, *args)

    def objects(self, groups: list[Group], triple: str, cpu: str) -> list[bytes]:
        """`frontend.module.object_of` of each group, in parallel."""
        if self.count < 2 or len(groups) < 2:
            return [object_of(group, triple, cpu) for group in groups]
        return [one.result() for one in [self.submit(object_of, group, triple, cpu) for group in groups]]


def all_parts(first: Iterable[Call], workers: Workers, progress: Callable[[int, int], None]) -> dict[Call, Part]:
    """The parts of these calls and of all that they call, from the store or compiled.

    Args:
        progress: called with the number of finished parts, and that of the parts known to be needed.
    """
    found: dict[Call, Part] = {}
    known: set[Call] = set()
    missing: list[Call] = []
    running: dict[Future[Any], Call] = {}
    all_kernels = kernels()

    def find(calls: Iterable[Call]) -> None:
        """Read the parts of these calls, and of all that they call, from the store; list those that it lacks."""
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
        progress(len(found), len(known))

    def add(call: Call, part: Part) -> None:
        """Store a compiled part, and find those that it calls."""
        store.write_part(call, part)
        found[call] = part
        find(part.calls)

    find(first)
    compiled = 0
    while missing or running:
        if not workers.started and (workers.count < 2 or compiled + len(missing) < _FEW):
            call = missing.pop()
            add(call, part_of(call))
            compiled += 1
            continue
        for call in missing:
            running[workers.submit(_compile, call[0].name, call[1])] = call
        missing.clear()
        for done in wait(running, return_when=FIRST_COMPLETED).done:
            key, bitcode, called, returned, seconds = done.result()
            call = running.pop(done)
            if key != store.part_key(call):
                raise RuntimeError(f"{call[0].name} was edited during the build: build again")
            add(call, Part(bitcode, [(all_kernels[name], args) for name, args in called], returned, seconds))
    return found


def default_workers() -> int:
    """One process for each core, eight at most."""
    return min(8, processors())
