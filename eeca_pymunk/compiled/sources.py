"""The sources of machine code, and the folders of libraries."""

from __future__ import annotations

import functools
import hashlib
import os
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from .entries import SOURCES
from .targets import TARGETS, this_platform

PACKAGE = Path(__file__).parents[1]


@functools.cache
def sources_hash(package: Path = PACKAGE) -> str:
    """32 hexadecimal digits that change with every edit of a file of `SOURCES`, whatever its line ends."""
    digest = hashlib.sha256()
    for room in (package / name for name in SOURCES):
        for one in sorted([*room.rglob("*.py"), *room.rglob("*.ll")]) if room.is_dir() else [room]:
            text = one.read_bytes().replace(b"\r\n", b"\n")
            digest.update(f"{one.relative_to(package).as_posix()}\0{len(text)}\0".encode())
            digest.update(text)
    return digest.hexdigest()[:32]


def library_name(platform: str | None = None) -> str:
    """The file name of the library of these sources, for this platform if none is named."""
    target = TARGETS.get(platform or this_platform())
    return f"kernels-{sources_hash()[:16]}-{platform or this_platform()}{target.ending if target else '.so'}"


def beside() -> Path:
    """The folder of libraries beside the sources."""
    return PACKAGE / "compiled" / "libraries"


def cache_folder() -> Path:
    """The folder named by EECA_PYMUNK_CACHE, or one of this user: for compiled parts, and for libraries of read-only
    packages."""
    if chosen := os.environ.get("EECA_PYMUNK_CACHE"):
        return Path(chosen)
    try:
        user = Path.home()
    except RuntimeError:  # of a user without an entry, in a container for instance
        user = Path(tempfile.gettempdir())
    if sys.platform == "win32":
        home = Path(os.environ.get("LOCALAPPDATA") or user / "AppData" / "Local")
    elif sys.platform == "darwin":
        home = user / "Library" / "Caches"
    else:
        home = Path(os.environ.get("XDG_CACHE_HOME") or user / ".cache")
    return home / "eeca_pymunk"


def writable(folder: Path) -> bool:
    """Whether files can be created in this folder, which is created if necessary."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


def library_folder() -> Path:
    """Where a library is written: beside the sources, or in the cache folder if that is read-only."""
    return beside() if writable(beside()) else cache_folder()


def library_path() -> Path | None:
    """The library of these sources for this platform; None if there is none."""
    for folder in (beside, cache_folder):
        if (path := folder() / library_name()).is_file():
            return path
    return None


def builder_environment(base: Mapping[str, str] = os.environ) -> dict[str, str]:
    """The environment of a process that builds from these sources, and not from those of the working folder."""
    paths = [str(PACKAGE.parent), *filter(None, [base.get("PYTHONPATH")])]
    return {**base, "PYTHONPATH": os.pathsep.join(paths), "PYTHONSAFEPATH": "1"}
