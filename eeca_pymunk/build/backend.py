"""The hooks of pip and `python -m build` (PEP 517, PEP 660): build the library of kernels, then call setuptools' hook.

A wheel contains the library and is specific to a platform, `py3-none-<platform>`, one for all Pythons; `pip install -e
.` leaves the library beside the sources. Both build it in an environment of their own, in which numba is installed, and
a linker if necessary; the environment of the user gets neither. `python -m build --wheel -Ctarget=win32-x86_64` builds
for another platform.

`-Ctarget=none` makes a wheel of plain Python; so does a platform for which numba has no wheels (PyPy, musl, macOS on
x86-64) or which `compiled.targets.TARGETS` does not contain.

This file is imported by itself, from this folder, before the package is installed.
"""

from __future__ import annotations

import base64
import contextlib
import hashlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from types import ModuleType
from typing import IO, Any

from setuptools import build_meta
from setuptools.build_meta import (  # noqa: F401 - hooks that stay as they are
    build_sdist,
    get_requires_for_build_sdist,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

ROOT = Path(__file__).parents[2]
NEWEST_PYTHON = (3, 15)  # for which numba has wheels
_DATE = (1980, 1, 1, 0, 0, 0)  # of all files of a wheel, so that equal sources give equal bytes


def _targets() -> ModuleType:
    """`compiled/targets.py`, loaded by its path, because the requirements of the package are not installed yet."""
    spec = importlib.util.spec_from_file_location("eeca_targets", ROOT / "eeca_pymunk" / "compiled" / "targets.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look it up
    spec.loader.exec_module(module)
    return module


def _requirements(portable: bool, config: dict[str, Any] | None) -> list[str]:
    """The requirements of the builder, read from pyproject.toml by regular expressions (Python 3.10 has no tomllib);
    empty if no library is built."""
    targets = _targets()
    name = (config or {}).get("target") or targets.this_platform()
    if name not in {*targets.TARGETS, "none", targets.this_platform()}:
        raise ValueError(f"-Ctarget={name}: choose one of {', '.join(targets.TARGETS)}, or none for plain Python")
    has_numba = sys.implementation.name == "cpython" and sys.version_info[:2] <= NEWEST_PYTHON
    if not has_numba or name not in targets.TARGETS or not targets.has_compiler():
        return []
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    extra = re.search(r"^build = \[(.*?)\]", text, flags=re.MULTILINE | re.DOTALL)
    runtime = re.search(r"^dependencies = \[(.*?)\]", text, flags=re.MULTILINE | re.DOTALL)
    assert extra is not None
    assert runtime is not None
    wanted = re.findall(r'"([^"]+)"', extra[1]) + [
        one for one in re.findall(r'"([^"]+)"', runtime[1]) if re.match(r"pymunk|numpy|tqdm|cffi", one)
    ]
    return wanted + (["ziglang"] if portable or not targets.linker(name) else [])


def get_requires_for_build_wheel(config_settings: dict[str, Any] | None = None) -> list[str]:
    return [*build_meta.get_requires_for_build_wheel(config_settings), *_requirements(True, config_settings)]


def get_requires_for_build_editable(config_settings: dict[str, Any] | None = None) -> list[str]:
    return [*build_meta.get_requires_for_build_editable(config_settings), *_requirements(False, config_settings)]


def _build(config: dict[str, Any] | None, portable: bool, folder: Path | None = None) -> tuple[Any, Path] | None:
    """Build the library. Returns its platform and its file, which `__main__` prints first in a line; None if there is
    none for the platform."""
    if not _requirements(portable, config):
        print("no library of kernels for this platform: plain Python", file=sys.stderr)
        return None
    targets = _targets()
    name = (config or {}).get("target") or targets.this_platform()
    call = [sys.executable, "-m", "eeca_pymunk.build", "--target", name, *(["--portable"] if portable else [])]
    call += ["--out", str(folder)] if folder else []
    # The build environment is on that path already.
    paths = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = os.environ | {"PYTHONPATH": paths, "PYTHONDONTWRITEBYTECODE": "1"}
    with _terminal() as terminal:
        done = subprocess.run(call, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=terminal, text=True)
    print(done.stdout)
    if done.returncode:
        raise RuntimeError(f"{' '.join(call)} failed: exit status {done.returncode}")
    found = re.search(r"^(.*kernels-\S+?)(?:  | is there)", done.stdout, flags=re.MULTILINE)
    assert found is not None
    return targets.TARGETS[name], Path(found[1])


def _terminal() -> contextlib.AbstractContextManager[IO[str] | None]:
    """The terminal, for a progress bar: pip hides what its backends print. None where there is no terminal."""
    try:
        return open("/dev/tty", "w")
    except OSError:
        return contextlib.nullcontext()


def build_editable(
    wheel_directory: str, config_settings: dict[str, Any] | None = None, metadata_directory: str | None = None
) -> str:
    _build(config_settings, portable=False)
    return str(build_meta.build_editable(wheel_directory, config_settings, metadata_directory))


def build_wheel(
    wheel_directory: str, config_settings: dict[str, Any] | None = None, metadata_directory: str | None = None
) -> str:
    with tempfile.TemporaryDirectory() as folder:
        return _wheel(wheel_directory, config_settings, metadata_directory, Path(folder))


def _wheel(
    wheel_directory: str, config_settings: dict[str, Any] | None, metadata_directory: str | None, folder: Path
) -> str:
    # The library beside the sources may be linked for this machine only; setuptools' folder may contain older files.
    built = _build(config_settings, True, folder)
    shutil.rmtree(ROOT / "build" / "lib", ignore_errors=True)
    ours = {key: value for key, value in (config_settings or {}).items() if key != "target"}
    name = str(build_meta.build_wheel(wheel_directory, ours, metadata_directory))
    return name if built is None else _with_library(Path(wheel_directory, name), *built)


def _with_library(pure: Path, target: Any, library: Path) -> str:
    """Put the library into a wheel of plain Python, which becomes specific to its platform; returns its file name."""
    made = pure.with_name(pure.name.replace("-none-any.whl", f"-none-{target.tag}.whl"))
    record: list[str] = []
    with zipfile.ZipFile(pure) as old, zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:

        def put(name: str, content: bytes) -> None:
            new.writestr(zipfile.ZipInfo(name, _DATE), content, zipfile.ZIP_DEFLATED)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{name},sha256={digest},{len(content)}")

        for name in sorted(old.namelist()):
            content = old.read(name)
            if name.endswith(".dist-info/RECORD"):
                listing = name
                continue
            if name.endswith(".dist-info/WHEEL"):
                text = content.decode().replace("Root-Is-Purelib: true", "Root-Is-Purelib: false")
                content = re.sub(r"^Tag: .*$", f"Tag: py3-none-{target.tag}", text, flags=re.MULTILINE).encode()
            put(name, content)
        put(f"eeca_pymunk/compiled/libraries/{library.name}", library.read_bytes())
        new.writestr(zipfile.ZipInfo(listing, _DATE), "\n".join([*record, f"{listing},,", ""]), zipfile.ZIP_DEFLATED)
    pure.unlink()
    return made.name
