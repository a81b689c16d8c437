"""sweep: in order, bitwise the same everywhere, and nothing lost when a case raises or a worker dies."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

import eeca_pymunk as ep
import scenes
from tests.test_rollouts import film

State = list[tuple[float, float, float, float]]


def gas(seed: int) -> State:
    """Where a gas is after some impacts."""
    scene = scenes.build("gas", count=6, seed=seed)
    stepper = ep.EECA(scene.space, sync=False)
    for _ in range(10):
        stepper.step(0.02)
    return [(*b.position, *b.velocity) for b in scene.bodies]


def late(case: int) -> int:
    """Earlier cases take longer."""
    time.sleep(0.02 * (4 - case % 5))
    return case * case


def picky(case: int) -> int:
    if case == 3:
        raise ValueError("three is refused")
    return case


def deadly(case: int) -> int:
    if case == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return case


def shot_once(case: tuple[int, str]) -> int:
    """Case 5 kills its worker when it runs for the first time."""
    number, mark = case
    if number == 5 and not Path(mark).exists():
        Path(mark).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


@pytest.fixture(scope="module")
def processes() -> Iterator[Executor]:
    ep.warmup()
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        yield pool


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Executor]:
    distributed = pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    import dask

    # A worker that dies is waited for no longer than that.
    waiting = {"distributed.comm.timeouts.connect": "3s"}
    with (
        dask.config.set(waiting),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0",
            local_directory=str(tmp_path_factory.mktemp("dask")),
        ) as local,
        distributed.Client(local) as client,
    ):  # fmt: skip
        yield client.get_executor()


@pytest.mark.parametrize("where", ["processes", "cluster"])
def test_bits_do_not_depend_on_where_a_case_runs(where: str, request: pytest.FixtureRequest) -> None:
    here = ep.sweep(gas, range(6))
    there = ep.sweep(gas, range(6), request.getfixturevalue(where))
    assert np.array(here).tobytes() == np.array(there).tobytes()
    assert len({str(one) for one in here}) == 6


@pytest.mark.parametrize("where", ["processes", "cluster"])
def test_rollouts_of_many_processes_are_those_of_one(where: str, request: pytest.FixtureRequest) -> None:
    found = ep.sweep(film, range(4), request.getfixturevalue(where))
    np.testing.assert_array_equal(np.array(found), np.array([film(case) for case in range(4)]))


def test_results_are_in_order_and_progress_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    with ThreadPoolExecutor(3) as pool:
        assert ep.sweep(late, iter(range(10)), pool, progress=True) == [i * i for i in range(10)]
    assert "10/10" in capsys.readouterr().err
    assert ep.sweep(late, [1, 2]) == [1, 4]
    assert capsys.readouterr().err == ""
    assert ep.sweep(late, []) == []


@pytest.mark.parametrize("where", ["here", "processes", "cluster"])
def test_a_case_that_raises_is_named_and_the_others_are_kept(where: str, request: pytest.FixtureRequest) -> None:
    executor = None if where == "here" else request.getfixturevalue(where)
    with pytest.raises(ep.SweepError, match=r"case 3 \(3\): ValueError: three is refused. 9 of 10") as caught:
        ep.sweep(picky, range(10), executor)
    assert caught.value.results == [0, 1, 2, None, 4, 5, 6, 7, 8, 9]
    assert list(caught.value.failed) == [3]
    assert isinstance(caught.value.__cause__, ValueError)


def test_a_case_that_kills_its_process_is_named_and_the_others_are_kept() -> None:
    with ProcessPoolExecutor(2) as pool, pytest.raises(ep.SweepError, match=r"case 3 \(3\): BrokenProcessPool") as e:
        ep.sweep(deadly, range(40), pool)
    assert e.value.results == [*range(3), None, *range(4, 40)]
    assert isinstance(e.value.failed[3], BrokenProcessPool)


def test_a_process_that_is_killed_costs_no_result(tmp_path: Path) -> None:
    cases = [(i, str(tmp_path / "mark")) for i in range(40)]
    with ProcessPoolExecutor(2) as pool:
        assert ep.sweep(shot_once, cases, pool) == list(range(40))
    assert (tmp_path / "mark").exists()


def test_a_worker_of_a_cluster_that_is_killed_costs_no_result(cluster: Executor, tmp_path: Path) -> None:
    cases = [(i, str(tmp_path / "mark")) for i in range(20)]
    assert ep.sweep(shot_once, cases, cluster) == list(range(20))
    assert (tmp_path / "mark").exists()


def test_a_case_that_kills_every_worker_of_a_cluster_is_named_and_the_others_are_kept(cluster: Executor) -> None:
    with pytest.raises(ep.SweepError, match=r"case 3 \(3\): KilledWorker") as caught:
        ep.sweep(deadly, range(10), cluster)
    assert caught.value.results == [*range(3), None, *range(4, 10)]
    assert list(caught.value.failed) == [3]


def test_a_case_that_its_executor_loses_is_handed_out_once_more() -> None:
    """As a cluster does when a worker dies between a result and its transport."""
    runs: list[int] = []

    class Forgetful(ThreadPoolExecutor):
        lost = 0

        def submit(self, fn, /, *args, **kwargs):  # type: ignore[no-untyped-def]
            if args[1] in (1, 4) and self.lost < 2:
                self.lost += 1
                future: Future[int] = Future()
                future.set_exception(TypeError("cannot unpack non-iterable int object"))
                return future
            return super().submit(fn, *args, **kwargs)

    def counted(case: int) -> int:
        runs.append(case)
        return picky(case)

    with Forgetful(2) as pool, pytest.raises(ep.SweepError, match=r"case 3 \(3\): ValueError") as caught:
        ep.sweep(counted, range(6), pool)
    assert caught.value.results == [0, 1, 2, None, 4, 5]
    assert sorted(runs) == list(range(6))  # what a case raises itself is believed at once


def test_an_executor_that_breaks_names_what_is_not_done() -> None:
    class Broken(ThreadPoolExecutor):
        def submit(self, fn, /, *args, **kwargs):  # type: ignore[no-untyped-def]
            if args[1] == 2:
                raise BrokenProcessPool("gone")
            return super().submit(fn, *args, **kwargs)

    with Broken(1) as pool, pytest.raises(ep.SweepError, match=r"case 2 \(2\): BrokenProcessPool: gone; case 3") as e:
        ep.sweep(late, range(5), pool)
    assert e.value.results == [0, 1, None, None, None]
