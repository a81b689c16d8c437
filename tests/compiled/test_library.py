"""The loader: what it refuses and how it says so, what entries refuse."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eeca_pymunk.compiled import library, sources
from eeca_pymunk.compiled.entries import ENTRIES
from eeca_pymunk.compiled.library import Status, load
from eeca_pymunk.compiled.records import rows
from eeca_pymunk.model.bodies import Body
from eeca_pymunk.transfer import write_states

compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler to make libraries with")
loaded = pytest.mark.skipif(sources.library_path() is None, reason="no library of these sources")


def made(folder: Path, text: str) -> Path:
    """A library of this C program."""
    path = folder / "made.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-x", "c", "-o", path, "-"], input=text.encode(), check=True)
    return path


def given() -> list[Any]:
    """Arguments of `write_states`, of three bodies at rest."""
    return [
        np.zeros((2, 3, 9)), np.zeros((4, 3), np.int64), np.zeros((3, 5)), rows(Body, 1), np.zeros(54), 1.0, 0
    ]  # fmt: skip


def test_no_library() -> None:
    assert load(None) == (Status.MISSING, {}, "")


def test_a_file_that_is_no_library(tmp_path: Path) -> None:
    path = tmp_path / "kernels.so"
    path.write_bytes(b"no machine code")
    status, entries, said = load(path)
    assert (status, entries) == (Status.UNREADABLE, {})
    assert "kernels.so" in said


@compiler
def test_a_library_without_hash(tmp_path: Path) -> None:
    assert load(made(tmp_path, "int other;"))[:2] == (Status.UNMARKED, {})


@compiler
def test_a_library_of_other_sources(tmp_path: Path) -> None:
    status, entries, said = load(made(tmp_path, f'const char eeca_sources[32] = "{"0" * 32}";'))
    assert (status, entries) == (Status.OUTDATED, {})
    assert said == f"{'0' * 32}, not {sources.sources_hash()}"


@compiler
def test_a_library_that_lacks_an_entry(tmp_path: Path) -> None:
    status, entries, said = load(made(tmp_path, f'const char eeca_sources[32] = "{sources.sources_hash()}";'))
    assert (status, entries) == (Status.INCOMPLETE, {})
    assert said == next(iter(ENTRIES))


def test_every_edit_and_every_name_changes_the_hash(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "SOURCES", ("one.py", "room"))
    hash_of = sources.sources_hash.__wrapped__
    (tmp_path / "room").mkdir()
    (tmp_path / "one.py").write_bytes(b"HALF = 0.5\n")
    (tmp_path / "room" / "two.py").write_bytes(b"TWO = 2\n")
    first = hash_of(tmp_path)
    assert first == hash_of(tmp_path)
    (tmp_path / "room" / "two.py").write_bytes(b"TWO = 2\r\n")
    assert hash_of(tmp_path) == first
    (tmp_path / "other.py").write_bytes(b"no kernels")
    assert hash_of(tmp_path) == first
    (tmp_path / "room" / "two.py").write_bytes(b"TWO = 3\n")
    second = hash_of(tmp_path)
    (tmp_path / "room" / "two.py").rename(tmp_path / "room" / "three.py")
    assert len({first, second, hash_of(tmp_path)}) == 3


def test_libraries_of_read_only_packages_are_kept_in_the_cache_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("EECA_PYMUNK_CACHE", str(tmp_path))
    assert sources.library_folder() == sources.beside()
    monkeypatch.setattr(sources.os, "access", lambda path, mode: False)
    assert sources.library_folder() == tmp_path


@loaded
@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({0: np.zeros((2, 3, 9), np.float32)}, "C-contiguous f8.3., not float32"),
        ({1: np.zeros((4, 3)).T}, "C-contiguous i8.2., not float64"),
        ({4: np.zeros((54, 1))}, "C-contiguous f8.1., not float64 of shape .54, 1."),
        ({4: np.zeros(108)[::2]}, "strides .16,."),
    ],
)
def test_entries_refuse_arrays_that_they_would_misread(change: dict[int, np.ndarray], told: str) -> None:
    entry = load(sources.library_path())[1][write_states.name]
    arguments = given()
    assert entry(*arguments) == 0
    for place, value in change.items():
        arguments[place] = value
    with pytest.raises(TypeError, match=told):
        entry(*arguments)
    with pytest.raises(TypeError, match="transfer:write_states takes 7 arguments, not 6"):
        entry(*arguments[:6])


@loaded
def test_statuses_of_kernels_become_exceptions() -> None:
    entry = library.Entry(write_states.name, 0)
    for status, error in ((library.NO_MEMORY, MemoryError), (library.NO_SHAPE, ValueError)):
        entry.function = lambda *_, status=status: status  # type: ignore[misc]
        with pytest.raises(error, match="transfer:write_states"):
            entry(*given())


@loaded
def test_the_library_is_the_only_thing_that_is_needed() -> None:
    code = "import sys, eeca_pymunk as ep; ep.warmup(); print([m for m in ('numba', 'llvmlite') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
