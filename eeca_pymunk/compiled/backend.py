"""The code that kernels run: the library, code compiled just in time, or plain Python.

In this order:

1. the library of these sources (`library.py`), which is built first if it is missing and the builder's requirements are
   installed (numba and a linker, `eeca_pymunk/build`): once, in a process of its own, with a progress bar;
2. code compiled just in time for this processor (`frontend/jit.py`), if numba is installed but nothing can be linked;
3. plain Python, some hundred times slower, with a warning.

The environment variable EECA_KERNELS (library, jit, python) chooses one of them; NUMBA_DISABLE_JIT=1 is plain Python.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from .frontend import NUMBA
from .library import Entry, Status, load
from .sources import builder_environment, library_folder, library_path, writable
from .targets import linker, this_platform

CHOICES = ("", "library", "jit", "python")
_PLAIN = "eeca_pymunk runs as plain Python, some hundred times slower"


@dataclass(frozen=True)
class Backend:
    """The code that kernels run.

    Attributes:
        kind: library, jit or python.
        why: reason of the choice, one sentence.
        entries: entry points as machine code, by name; empty for python.
    """

    kind: str
    why: str
    entries: Mapping[str, Entry] = field(default_factory=dict)


_lock = threading.Lock()
_chosen: Backend | None = None


def start() -> Backend:
    """The backend of this process, chosen at the first call; later calls take no time."""
    global _chosen
    if _chosen is None:
        with _lock:
            if _chosen is None:
                _chosen = choose(build=True)
                if _chosen.kind == "python" and not chosen_by_user():
                    warnings.warn(f"{_PLAIN}: {_chosen.why}", stacklevel=5)
    return _chosen


def chosen_by_user() -> str:
    """The backend that the environment sets, "" for none.

    Raises:
        ValueError: EECA_KERNELS is something else.
    """
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return "python"
    choice = os.environ.get("EECA_KERNELS", "")
    if choice not in CHOICES:
        raise ValueError(f"EECA_KERNELS={choice}: choose one of {', '.join(CHOICES[1:])}, or leave it unset")
    return choice


def choose(build: bool) -> Backend:
    """The backend of this process; a missing library is built only if `build`.

    Raises:
        ImportError: EECA_KERNELS names a backend that is not available.
    """
    choice = chosen_by_user()
    if choice == "python":
        return Backend("python", "set by the environment (NUMBA_DISABLE_JIT or EECA_KERNELS)")
    why = ""
    if choice != "jit":
        status, entries, why, path = _library()
        if status is not Status.LOADED and (reason := cannot_build()) == "":
            if not build:
                return Backend("library", "there is none of these sources yet; it is built at the first step")
            why = _build()
            status, entries, more, path = _library()
            why = why or more
        elif status is not Status.LOADED:
            why = f"{why}; {reason}" if why else reason
        if status is Status.LOADED:
            return Backend("library", f"{path}", entries)
        why = f"library: {status.value}{f' ({why})' if why else ''}"
        if choice == "library":
            raise ImportError(f"EECA_KERNELS=library, but {why}")
    wrong = wrong_numba()
    if not wrong:
        if not build:
            return Backend("jit", why or "set by EECA_KERNELS")
        from .frontend.jit import compiled_entries

        try:
            return Backend("jit", why or "set by EECA_KERNELS", compiled_entries())
        except ImportError as error:
            wrong = str(error)
    if choice == "jit":
        raise ImportError(f"EECA_KERNELS=jit, but {wrong}")
    return Backend("python", f"{why}; just in time: {wrong}. {advice()}")


def _library() -> tuple[Status, dict[str, Entry], str, Path | None]:
    """The library of these sources: its status, entries, the error message of the system, and its file."""
    try:
        path = library_path()
    except OSError as error:
        return Status.UNKNOWN, {}, str(error), None
    return *load(path), path


def advice() -> str:
    """How to get machine code, for messages."""
    return (
        "In a clone: pip install -e . (builds it once), or pip install -e '.[build]' (builds it after every edit). "
        "Else: install a wheel for this platform"
    )


def cannot_build() -> str:
    """Why the library cannot be built here; "" if it can."""
    if wrong := wrong_numba():
        return wrong
    if not writable(library_folder()):
        return f"{library_folder()} is read-only"
    return "" if linker(this_platform()) else "there is no linker: install a C compiler, or pip install ziglang"


def wrong_numba() -> str:
    """Why numba cannot compile the kernels; "" if it can."""
    found = _found()
    if found is None:
        return "numba is not installed"
    return "" if found.startswith(f"{NUMBA}.") else f"numba {found} is installed, the compiler needs {NUMBA}"


def _found() -> str | None:
    """The installed version of numba, without importing it; None if there is none."""
    if sys.modules.get("numba", ...) is None:  # import statements treat None as missing
        return None
    try:
        return version("numba")
    except PackageNotFoundError:
        return None


def _build() -> str:
    """Build the library in another process, which shows its progress; what went wrong, "" if nothing did."""
    call = [sys.executable, "-m", "eeca_pymunk.build"]
    done = subprocess.run(call, env=builder_environment(), stdout=subprocess.DEVNULL)
    return "" if done.returncode == 0 else f"python -m eeca_pymunk.build failed with exit status {done.returncode}"
