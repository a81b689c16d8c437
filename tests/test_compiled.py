"""Compiling: everything at a warmup, nothing more afterwards, and the package without numba."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec, TypeVar

import numpy as np
import pytest
from eeca_pymunk.fetching import fetch
from eeca_pymunk.indexing import count_from_the_start

import eeca_pymunk as ep
from eeca_pymunk import compiled
from eeca_pymunk.arrays import FloatArray

P = ParamSpec("P")
R = TypeVar("R")
STEP = """
import sys, warnings
{hide}
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    import eeca_pymunk as ep
    assert "numba" not in sys.modules or sys.modules["numba"] is None, "numba was imported with the package"
    assert not caught, caught[0].message
    from eeca_pymunk.space.sample import sample
    for kind in ("disks", "boxes"):
        space = sample(kind)
        stepper = ep.EECA(space)
        contacts = sum(len(stepper.step(0.02).contacts) for _ in range(3))
        assert contacts > 0
        print([tuple(b.position) for b in space.bodies])
print([str(w.message) for w in caught])
"""


@compiled.uncounted
def spread(several: bool, i: int) -> float:
    return 0.5 * i if several else 1.0 * i


def fresh(python: Callable[P, R]) -> compiled.Kernel[P, R]:
    """A kernel that is compiled in every run: what comes from disk cannot be looked into."""
    return compiled.Kernel(python, cache=False)


@fresh
def callers(n: int) -> float:
    return spread(False, 0) + spread(True, 1) + spread(n > 2, n)


@pytest.mark.skipif(compiled.compiler() is None, reason="plain Python")
def test_constants_do_not_make_kernels_anew() -> None:
    assert callers(4) == 2.5
    assert len(spread.inner.signatures) == 1  # type: ignore[attr-defined]


@compiled.uncounted
def every_other(table: FloatArray, row: int) -> float:
    total = 0.0
    for k in range(0, table.shape[0], 2):
        fetch(table, k + row, 1)
        total += table[k, 1]
    return total


@fresh
def asks_for_rows(table: FloatArray, row: int) -> float:
    return every_other(table, row)


def test_rows_are_asked_for_and_nothing_else_happens() -> None:
    table = np.arange(12.0).reshape(6, 2)
    for row in (0, -3, 10**9):  # what is in no row is not there to be brought
        assert asks_for_rows(table, row) == 15.0
    if compiled.compiler() is not None:
        assert "prefetch" in asks_for_rows.run.inspect_asm(asks_for_rows.run.signatures[0])  # type: ignore[attr-defined]


@fresh
def there_and_back(x: float) -> float:
    return (x + 1.0) - x


def test_sums_are_not_reordered() -> None:
    """As `fastmath` would, which would find 1 here: energies close by the order of their sums."""
    assert there_and_back(1e16) == 0.0


def test_machine_code_is_kept_by_a_hash_of_all_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An edit of any file of the package makes another folder, the same sources the same."""
    monkeypatch.setattr(compiled, "_PACKAGE", tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    folder = compiled.cache_folder.__wrapped__
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "one.py").write_text("HALF = 0.5\n")
    first = folder()
    assert first.parent == tmp_path / "__pycache__"
    assert first == folder()
    (tmp_path / "room" / "one.py").write_text("HALF = 0.6\n")
    second = folder()
    (tmp_path / "room" / "one.py").rename(tmp_path / "room" / "two.py")
    assert len({first, second, folder()}) == 3
    monkeypatch.setattr(compiled.os, "access", lambda path, mode: False)
    assert folder().parent == tmp_path / "home" / "eeca_pymunk"


@pytest.mark.skipif(compiled.compiler() is None, reason="plain Python")
@pytest.mark.parametrize("terminal", [True, False])
def test_one_line_tells_of_the_first_compilation_at_a_terminal(
    terminal: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    compiled.prepare()  # all others have their folder
    monkeypatch.setattr(compiled, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(compiled.sys.stderr, "isatty", lambda: terminal)
    one = fresh(lambda x: x + 1.0)
    compiled.prepare()
    assert capsys.readouterr().err == ("compiling eeca_pymunk's kernels, once\n" if terminal else "")
    assert one(1.0) == 2.0
    (tmp_path / "some.nbi").touch()
    fresh(lambda x: x + 2.0)
    compiled.prepare()
    assert capsys.readouterr().err == ""


def run(code: str) -> list[str]:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.splitlines()


@pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="there is none to be without")
def test_without_numba_one_warning_and_the_same_motion() -> None:
    *places, warned = run(STEP.format(hide='sys.modules["numba"] = None'))
    assert warned.startswith("['numba is not installed: eeca_pymunk runs as plain Python")
    assert warned.count("numba is not installed") == 1
    *compiled_places, silence = run(STEP.format(hide=""))
    assert silence == "[]"
    for line, other in zip(places, compiled_places, strict=True):
        for one, two in zip(eval(line), eval(other), strict=True):
            assert one == pytest.approx(two, rel=1e-12, abs=1e-12)


def test_warmup_compiles_everything() -> None:
    code = """
import eeca_pymunk as ep, scenes
from eeca_pymunk import compiled
from eeca_pymunk.indexing import count_from_the_start
import pymunk
seconds = ep.warmup()
assert seconds > 0.0
before = compiled.compilations()
spaces = [scenes.build("gas", count=n).space for n in (3, 40)] + [scenes.build("mixed", bowl=True).space]
spaces.append(scenes.build("colours").space)
for space in spaces:
    for shape in list(space.shapes)[::2]:
        shape.elasticity = 0.5
    for _ in range(10):
        ep.EECA(space).step(0.01)
print(compiled.disabled() or compiled.compiler() is None, before, compiled.compilations())
"""
    off, before, after = run(code)[-1].split()
    assert before == after
    assert off == "True" or int(before) > 0


def test_a_warmup_touches_no_space_of_the_caller() -> None:
    assert ep.warmup() > 0.0
    assert compiled.compilations() >= 0


@pytest.mark.skipif(compiled.compiler() is None, reason="plain Python counts from the end")
def test_indices_of_kernels_are_taken_as_they_are() -> None:
    import numba
    import numpy as np

    def at(values: np.ndarray, i: int) -> float:
        return float(values[i])

    def last(values: np.ndarray) -> float:
        return float(values[-1])

    assert count_from_the_start(), "numba has changed: kernels are slower by a sixth"
    row = np.arange(6.0)
    theirs = numba.njit(at)
    assert theirs(row[2:5], -1) == 4.0
    for ours in (at, last):
        ours.__module__ = "eeca_pymunk.example"
    assert numba.njit(at)(row[2:5], -1) == 1.0  # what stands before the view
    assert numba.njit(at)(row[2:5], 1) == 3.0
    assert numba.njit(last)(row[2:5]) == 4.0
