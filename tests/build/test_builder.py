"""The builder: what goes into which module, older libraries, the command line."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

import pytest

from eeca_pymunk.build.__main__ import main
from eeca_pymunk.compiled.sources import library_path
from eeca_pymunk.compiled.targets import TARGETS, linker, this_platform

needs_compiler = pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="numba is not installed")


def test_a_library_that_is_there_is_not_built_again(capsys: pytest.CaptureFixture[str]) -> None:
    if (path := library_path()) is None or importlib.util.find_spec("numba") is None:
        pytest.skip("nothing to build, or nothing to build with")
    assert main(["--out", str(path.parent)]) == 0
    assert capsys.readouterr().out == f"{path} is there already; --force builds it again\n"


@pytest.mark.skipif(importlib.util.find_spec("numba") is not None, reason="numba is installed")
def test_without_numba_the_command_says_what_to_install(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--out", str(tmp_path)]) == 2
    assert "pip install -e '.[build]'" in capsys.readouterr().err


def test_targets_have_linkers_and_tags(monkeypatch: pytest.MonkeyPatch) -> None:
    assert {target.tag.split("_")[0] for target in TARGETS.values()} == {"manylinux", "win", "macosx"}
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert linker("win32-aarch64") == []
    others = [name for name in TARGETS if name != this_platform()]
    assert [linker(name) for name in others] == [[]] * len(others)
    assert linker(this_platform(), portable=True) == []
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: name)
    assert linker("linux-aarch64")[-2:] == ["-target", "aarch64-linux-gnu.2.17"]


@needs_compiler
def test_older_libraries_are_left_for_a_while(tmp_path: Path) -> None:
    from eeca_pymunk.build.builder import remove_older

    paths = [tmp_path / f"kernels-{number:016x}-linux-x86_64.so" for number in range(9)]
    for age, path in enumerate(paths):
        path.write_bytes(b"")
        os.utime(path, (1e9 - age, 1e9 - age))
    other = tmp_path / f"kernels-{0:016x}-linux-aarch64.so"
    other.write_bytes(b"")
    remove_older(paths[-1])
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(p.name for p in [*paths[:6], paths[-1], other])


@needs_compiler
def test_every_kernel_is_in_a_module_and_every_call_finds_it() -> None:
    from eeca_pymunk.build.builder import two_groups
    from eeca_pymunk.build.workers import Workers, all_parts, import_kernels
    from eeca_pymunk.compiled.entries import ENTRIES
    from eeca_pymunk.compiled.frontend import module

    import_kernels()
    names = ("transfer:write_ends", "joints.workspace:plan_components", "islands.accounting:flag_pairs")
    calls = {name: module.entry_call(name) for name in names}
    with Workers(1) as workers:
        found = all_parts(calls.values(), workers, lambda done, known: None)
    groups = two_groups(calls, found)
    assert sorted(name for group in groups for name, _ in group.entries) == sorted(names)
    for group, other in ((groups[0], groups[1]), (groups[1], groups[0])):
        assert group.foreign == other.public
        assert module.linked(group) is not None  # refuses what calls find nowhere
    assert set(names) < set(ENTRIES)
