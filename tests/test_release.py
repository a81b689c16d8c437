"""What is released: a wheel with the package alone, a source archive with all; what `python -m eeca_pymunk` says."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

import eeca_pymunk
from eeca_pymunk.__main__ import lines

ROOT = Path(__file__).parents[1]


def declared() -> str:
    found = re.search(r'^version = "(.+)"$', (ROOT / "pyproject.toml").read_text(), flags=re.MULTILINE)
    assert found is not None
    return found[1]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the source archive and the wheel that is made from it."""
    pytest.importorskip("build", reason="the extra `test` is not installed")
    folder = tmp_path_factory.mktemp("dist")
    done = subprocess.run(
        [sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT)], capture_output=True, text=True
    )
    if "No matching distribution found for setuptools" in done.stdout + done.stderr:
        pytest.skip("no package index within reach")
    assert done.returncode == 0, done.stderr
    return folder


def test_wheel_has_the_package_and_nothing_else(built: Path) -> None:
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as held:
        names = held.namelist()
    assert wheel.name.startswith(f"eeca_pymunk-{declared()}-")
    assert {name.split("/")[0] for name in names} == {"eeca_pymunk", f"eeca_pymunk-{declared()}.dist-info"}
    package = Path(eeca_pymunk.__file__).parent
    sources = {f"eeca_pymunk/{p.relative_to(package).as_posix()}" for p in package.rglob("*.py")}
    assert sources | {"eeca_pymunk/py.typed"} == {name for name in names if name.startswith("eeca_pymunk/")}


def test_source_archive_has_scenes_comparisons_and_tests(built: Path) -> None:
    (archive,) = built.glob("*.tar.gz")
    with tarfile.open(archive) as held:
        names = {name.split("/", 1)[1] for name in held.getnames() if "/" in name}
    assert {"README.md", "CHANGELOG.md", "pyproject.toml", "LICENSE"} <= names
    for folder in ("scenes", "comparisons", "tests"):
        assert {p.relative_to(ROOT).as_posix() for p in (ROOT / folder).rglob("*.py")} <= names
    assert not any(name.endswith(".pyc") for name in names)


def test_version_is_the_changelogs_and_the_citations() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text()
    newest = re.search(r"^## (\S+)", changes, flags=re.MULTILINE)
    assert newest is not None
    assert newest[1] == declared()
    assert f"\nversion: {declared()}\n" in (ROOT / "CITATION.cff").read_text()


@pytest.mark.parametrize(
    ("hide", "environment", "kernels"),
    [
        ("", {"NUMBA_DISABLE_JIT": "0"}, "compiled"),
        ("", {"NUMBA_DISABLE_JIT": "1"}, "plain Python, as NUMBA_DISABLE_JIT=1 asks for"),
        ("sys.modules['numba'] = None;", {"NUMBA_DISABLE_JIT": "0"}, "plain Python, some hundred times slower"),
    ],
)
def test_module_prints_versions_and_whether_kernels_are_compiled(
    hide: str, environment: dict[str, str], kernels: str
) -> None:
    code = f"import sys, runpy; {hide} runpy.run_module('eeca_pymunk', run_name='__main__')"
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | environment, capture_output=True, text=True, check=True, cwd=ROOT
    )
    said = dict(line.split(maxsplit=1) for line in done.stdout.splitlines())
    assert list(said) == ["python", "eeca-pymunk", "pymunk", "numpy", "numba", "kernels"]
    assert said["kernels"].startswith(kernels)
    assert done.stderr == ""


def test_lines_say_where_machine_code_is_kept_or_why_there_is_none() -> None:
    assert re.search(r"kernels-[0-9a-f]{16}|plain Python", lines()[-1])
