"""sweep: one function over many cases, in this process or on any executor, without losing finished results."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from typing import Any, Generic, TypeVar

from tqdm import tqdm

Case = TypeVar("Case")
Result = TypeVar("Result")
_SHOWN = 3  # failed cases that a message names, at most
_LONGEST = 80  # characters of a case in a message, at most
_RAISED = "_raised_by_its_case"  # attribute of exceptions that a case has raised, and not the executor
_AHEAD = 2  # cases submitted for each worker of a pool of processes; if it breaks, any of them may be the cause


class SweepError(RuntimeError):
    """Some cases have no result; the results of all others are in this exception.

    Attributes:
        results: in the order of the cases, None if there is none.
        failed: the exception of each case without a result, by its index.
    """

    def __init__(self, cases: Sequence[Any], results: list[Any], failed: dict[int, BaseException]) -> None:
        self.results, self.failed = results, failed
        named = [f"case {i} ({_short(cases[i])}): {_reason(failed[i])}" for i in sorted(failed)[:_SHOWN]]
        rest = f"; and {len(failed) - _SHOWN} more" if len(failed) > _SHOWN else ""
        done = len(cases) - len(failed)
        super().__init__(f"{'; '.join(named)}{rest}. {done} of {len(cases)} cases are done: see .results and .failed")


def sweep(
    function: Callable[[Case], Result], cases: Iterable[Case], executor: Executor | None = None, progress: bool = False
) -> list[Result]:
    """`[function(case) for case in cases]`, in order; on the workers of an executor if one is given.

    Results do not depend on where they are computed: a case that builds its own space gives the same bits in this
    process, in a pool of processes or on a cluster of machines of one kind.

    Args:
        function: takes a case, returns its result. For processes and clusters: a function of a module.
        cases: its arguments.
        executor: any `concurrent.futures.Executor`: `ProcessPoolExecutor(4)`, dask's `Client(...).get_executor()`,
            `mpi4py.futures.MPIPoolExecutor()`. Call `warmup()` before, so that workers find the library built.
        progress: show a progress bar.

    A case that raises does not stop the others; `SweepError` then names it and has all results.

    ProcessPoolExecutor: a case whose process dies is tried once more, alone in a new process; if that dies too, the
    case has failed. The others continue in a new pool of as many processes. Other executors replace their workers
    themselves, as dask does: a case that fails by an exception that it did not raise itself is submitted once more,
    alone, after the others. If such an executor breaks, the unfinished cases are named.
    """
    held = list(cases)
    work = _Work(function, held, tqdm(total=len(held), desc="sweep", unit="case", disable=not progress))
    with work.bar:
        if executor is None:
            work.here()
        elif isinstance(executor, ProcessPoolExecutor):
            work.on_processes(executor)
        else:
            work.on_workers(executor)
    if work.failed:
        found = [work.done.get(i) for i in range(len(held))]
        raise SweepError(held, found, work.failed) from work.failed[min(work.failed)]
    return [work.done[i] for i in range(len(held))]


class _Work(Generic[Case, Result]):
    """Finished and failed cases of a sweep, by their indices."""

    def __init__(self, function: Callable[[Case], Result], cases: Sequence[Case], bar: tqdm[Any]) -> None:
        self.function, self.cases, self.bar = function, cases, bar
        self.done: dict[int, Result] = {}
        self.failed: dict[int, BaseException] = {}

    def here(self) -> None:
        """All cases in this process."""
        for i, case in enumerate(self.cases):
            try:
                self.done[i] = self.function(case)
            except Exception as error:
                self.failed[i] = error
            self.bar.update()

    def on_processes(self, executor: ProcessPoolExecutor) -> None:
        """All cases in the processes of a pool, which breaks as a whole when one of them dies."""
        workers = int(getattr(executor, "_max_workers", 1))
        doubtful = self.on(executor, range(len(self.cases)), _AHEAD * workers)
        while doubtful:
            for i in doubtful:
                # Alone: if the process dies now, this case is the cause.
                with _like(executor, 1) as alone:
                    self.again(alone, i)
            with _like(executor, workers) as another:
                doubtful = self.on(another, self.left(), _AHEAD * workers)

    def on_workers(self, executor: Executor) -> None:
        """All cases on an executor that replaces its workers itself.

        A worker that dies loses its results that were not sent yet, and its waiting cases.
        """
        broken = self.on(executor, range(len(self.cases)), len(self.cases))
        for i in sorted(self.failed):
            if not broken and not getattr(self.failed[i], _RAISED, False):
                broken = self.again(executor, i)
        for i in self.left():
            self.failed[i] = self.failed[broken[0]]

    def again(self, executor: Executor, i: int) -> list[int]:
        """Try a failed case once more, alone."""
        del self.failed[i]
        self.bar.update(-1)
        return self.on(executor, [i], 1, turn=2)

    def left(self) -> list[int]:
        """Indices of the cases that are neither done nor failed."""
        return [i for i in range(len(self.cases)) if i not in self.done and i not in self.failed]

    def on(self, executor: Executor, indices: Iterable[int], most: int, turn: int = 1) -> list[int]:
        """Run cases, at most `most` submitted at a time, in attempt number `turn`; returns those that were submitted
        and not done when the executor broke, empty if it did not."""
        waiting, submitted = deque(indices), dict[Future[Result], int]()
        broken: list[int] = []
        try:
            while submitted or (waiting and not broken):
                while waiting and len(submitted) < most and not broken:
                    try:
                        future = executor.submit(_attempt, self.function, self.cases[waiting[0]], turn)
                        submitted[future] = waiting[0]
                    except BrokenExecutor as error:
                        broken.append(waiting[0])
                        self._fail(waiting[0], error)
                    waiting.popleft()
                for future in wait(submitted, return_when=FIRST_COMPLETED).done:
                    i, raised = submitted.pop(future), CancelledError() if future.cancelled() else future.exception()
                    if raised is None:
                        self.done[i] = future.result()
                        self.bar.update()
                        continue
                    self._fail(i, raised)
                    if isinstance(raised, BrokenExecutor):
                        broken.append(i)
        finally:
            for future in submitted:
                future.cancel()
        return broken

    def _fail(self, i: int, error: BaseException) -> None:
        self.failed[i] = error
        self.bar.update()


def _attempt(function: Callable[[Case], Result], case: Case, turn: int) -> Result:
    """Run one case, and mark an exception that it raises itself.

    `turn` distinguishes attempts for executors that identify tasks by their arguments.
    """
    try:
        return function(case)
    except Exception as error:
        error.__dict__[_RAISED] = True  # kept by pickle
        raise


def _like(executor: ProcessPoolExecutor, workers: int) -> ProcessPoolExecutor:
    """A new pool with the start method and initializer of this one."""
    context, start = getattr(executor, "_mp_context", None), getattr(executor, "_initializer", None)
    return ProcessPoolExecutor(workers, context, start, getattr(executor, "_initargs", ()))


def _short(case: object) -> str:
    text = repr(case)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def _reason(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
