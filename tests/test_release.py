"""What is released: a wheel with the package alone, a source archive with all; what `python -m eeca_pymunk` says."""

from __future__ import annotations

import base64
import hashlib
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

import eeca_pymunk
from eeca_pymunk.__main__ import lines
from eeca_pymunk.compiled.sources import library_name, sources_hash
from eeca_pymunk.compiled.targets import TARGETS, this_platform

ROOT = Path(__file__).parents[1]


def declared() -> str:
    found = re.search(r'^version = "(.+)"$', (ROOT / "pyproject.toml").read_text(), flags=re.MULTILINE)
    assert found is not None
    return found[1]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the source archive and the wheel that is made from it."""
    pytest.importorskip("build", reason="the extra `test` is not installed")
    if not (ROOT / "eeca_pymunk").is_dir():
        pytest.skip("the tests run on an installed package: there are no sources to build of")
    folder = tmp_path_factory.mktemp("dist")
    done = subprocess.run(
        [sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT)], capture_output=True, text=True
    )
    if "No matching distribution found for setuptools" in done.stdout + done.stderr:
        pytest.skip("no package index within reach")
    assert done.returncode == 0, done.stderr
    return folder


def test_wheel_has_the_package_with_its_library_and_nothing_else(built: Path) -> None:
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as held:
        names = held.namelist()
        record = held.read(f"eeca_pymunk-{declared()}.dist-info/RECORD").decode().splitlines()
        about = held.read(f"eeca_pymunk-{declared()}.dist-info/WHEEL").decode()
        (library,) = [name for name in names if "/libraries/" in name]
        code = held.read(library)
    tag = TARGETS[this_platform()].tag
    assert wheel.name == f"eeca_pymunk-{declared()}-py3-none-{tag}.whl"
    assert "Root-Is-Purelib: false" in about
    assert f"Tag: py3-none-{tag}\n" in about
    assert wheel.stat().st_size < 3e6
    assert library == f"eeca_pymunk/compiled/libraries/{library_name()}"
    assert sources_hash().encode() in code
    assert {name.split("/")[0] for name in names} == {"eeca_pymunk", f"eeca_pymunk-{declared()}.dist-info"}
    package = Path(eeca_pymunk.__file__).parent
    sources = {f"eeca_pymunk/{p.relative_to(package).as_posix()}" for p in package.rglob("*.py")}
    others = {"eeca_pymunk/py.typed", "eeca_pymunk/compiled/frontend/runtime.ll", library}
    assert sources | others == {name for name in names if name.startswith("eeca_pymunk/")}
    # Every file with its hash, as installers check it.
    listed = {line.split(",")[0]: line.split(",")[1] for line in record}
    assert set(listed) == set(names)
    digest = base64.urlsafe_b64encode(hashlib.sha256(code).digest()).rstrip(b"=").decode()
    assert listed[library] == f"sha256={digest}"


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
    newest = re.search(r"^## \[(\d\S*)\] - \d{4}-\d\d-\d\d$", changes, flags=re.MULTILINE)
    assert newest is not None
    assert newest[1] == declared()
    assert changes.count("\n## [Unreleased]\n") == 1
    kinds = set(re.findall(r"^### (.*)$", changes, flags=re.MULTILINE))
    assert kinds <= {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    assert f"\nversion: {declared()}\n" in (ROOT / "CITATION.cff").read_text()


def test_lines_say_which_library_runs_or_why_there_is_none() -> None:
    assert re.search(r"kernels-[0-9a-f]{16}-|plain Python|just in time", lines()[-1])
