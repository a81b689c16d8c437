"""Which code kernels run, and why: library, just in time, plain Python; first calls from many threads."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled import backend, kernels, sources
from eeca_pymunk.compiled.frontend import NUMBA
from eeca_pymunk.compiled.library import Status

STEP = """
import sys, warnings
{before}
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    import eeca_pymunk as ep
    assert not sys.modules.get("numba"), "numba was imported with the package"
    assert not caught, caught[0].message
    from tests.compiled.sample import sample
    for kind in ("disks", "boxes"):
        space = sample(kind)
        stepper = ep.EECA(space)
        contacts = sum(len(stepper.step(0.02).contacts) for _ in range(3))
        assert contacts > 0
        print([tuple(b.position) for b in space.bodies])
print([str(w.message) for w in caught])
"""
ALONE = 'sys.modules["numba"] = None'


def run(code: str, **environment: str) -> list[str]:
    plain = {"NUMBA_DISABLE_JIT": "0", "EECA_KERNELS": ""}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ | plain | environment
    )
    return done.stdout.splitlines()


@pytest.mark.skipif(sources.library_path() is None, reason="no library of these sources")
def test_plain_python_moves_bodies_as_the_library_does() -> None:
    *places, silence = run(STEP.format(before=ALONE))
    assert silence == "[]"
    *others, quiet = run(STEP.format(before=ALONE), EECA_KERNELS="python")
    assert quiet == "[]"  # it was asked for
    for line, other in zip(places, others, strict=True):
        for one, two in zip(eval(line), eval(other), strict=True):
            assert one == pytest.approx(two, rel=1e-12, abs=1e-12)


def test_without_library_and_numba_one_warning_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backend, "library_path", lambda: None)
    monkeypatch.setattr(backend, "_chosen", None)
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    monkeypatch.delenv("EECA_KERNELS", raising=False)
    with pytest.warns(
        UserWarning, match="plain Python, some hundred times slower.*none of these sources.*In a clone: pip install"
    ):
        assert backend.start().kind == "python"
    assert backend.start().kind == "python"  # silently


def test_a_library_that_cannot_be_had_is_refused_if_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backend, "library_path", lambda: None)
    monkeypatch.setattr(backend, "cannot_build", lambda: "no linker")
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    monkeypatch.setenv("EECA_KERNELS", "library")
    with pytest.raises(
        ImportError, match=r"but library: there is none of these sources for this platform \(no linker\)"
    ):
        backend.choose(build=True)
    monkeypatch.setenv("EECA_KERNELS", "fast")
    with pytest.raises(ValueError, match="EECA_KERNELS=fast: choose one of library, jit, python"):
        backend.choose(build=True)


def test_reasons_against_building(monkeypatch: pytest.MonkeyPatch) -> None:
    for wrong, said in (("0.61.2", "numba 0.61.2 is installed, the compiler needs"), (None, "numba is not installed")):
        monkeypatch.setattr(backend, "_found", lambda wrong=wrong: wrong)
        assert said in backend.cannot_build()
    monkeypatch.setattr(backend, "_found", lambda: f"{NUMBA}.0")
    monkeypatch.setattr(backend, "writable", lambda folder: False)
    assert "read-only" in backend.cannot_build()
    monkeypatch.setattr(backend, "writable", lambda folder: True)
    monkeypatch.setattr(backend, "linker", lambda name: [])
    assert "ziglang" in backend.cannot_build()


def test_a_missing_library_is_built_once(monkeypatch: pytest.MonkeyPatch) -> None:
    built: list[int] = []
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    monkeypatch.delenv("EECA_KERNELS", raising=False)
    monkeypatch.setattr(backend, "library_path", lambda: (built and "path") or None)
    monkeypatch.setattr(backend, "load", lambda path: (Status.LOADED if path else Status.MISSING, {}, ""))
    monkeypatch.setattr(backend, "cannot_build", lambda: "")
    monkeypatch.setattr(backend, "_build", lambda: built.append(1) or "")  # type: ignore[func-returns-value]
    assert backend.choose(build=True) == backend.Backend("library", "path")
    assert backend.choose(build=True).kind == "library"
    assert built == [1]


def test_first_calls_from_many_threads() -> None:
    code = """
import threading
import eeca_pymunk as ep
from tests.compiled.sample import sample
gate, wrong, places = threading.Barrier(8), [], []
def work():
    try:
        gate.wait()
        space = sample("disks")
        ep.EECA(space).step(0.02)
        places.append([tuple(b.position) for b in space.bodies])
    except BaseException as error:
        wrong.append(error)
threads = [threading.Thread(target=work) for _ in range(8)]
[t.start() for t in threads]
[t.join() for t in threads]
print(wrong, len(places), all(p == places[0] for p in places))
"""
    assert run(code) == ["[] 8 True"]
    assert run(code, EECA_KERNELS="python") == ["[] 8 True"]


def test_kernels_that_are_no_entries_run_as_plain_python() -> None:
    @kernels.nonallocating
    def half(x: float) -> float:
        return 0.5 / x

    assert half(2.0) == 0.25
    assert ep.warmup() >= 0.0


def test_the_command_line_says_which_code_runs_and_why() -> None:
    code = "import runpy; runpy.run_module('eeca_pymunk', run_name='__main__')"
    for environment, said in (
        ({"NUMBA_DISABLE_JIT": "1"}, "plain Python, some hundred times slower: set by the environment"),
        ({"EECA_KERNELS": "python"}, "plain Python, some hundred times slower: set by the environment"),
        *([({}, "library: ")] if sources.library_path() else []),
    ):
        lines = dict(line.split(maxsplit=1) for line in run(code, **environment))
        assert list(lines) == ["python", "eeca-pymunk", "pymunk", "numpy", "numba", "kernels"]
        assert lines["kernels"].startswith(said)
