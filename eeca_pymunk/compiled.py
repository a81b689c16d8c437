"""The one decorator of compiled kernels: numba where it is installed, plain Python where it is not.

A kernel takes arrays and numbers, returns numbers or a status, and knows nothing of pymunk. numba itself is imported at
the first call of a kernel, never at import of the package. Machine code is kept on disk, in a folder named by a hash
of the package's sources: numba notices an edit of a function, but not of what that function calls.
"""

from __future__ import annotations

import functools
import hashlib
import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar

import numpy as np

from .indexing import count_from_the_start
from .linking import pipelines

P = ParamSpec("P")
R = TypeVar("R")
_PACKAGE = Path(__file__).parent
_OPTIONS = {"cache": True, "fastmath": False, "error_model": "numpy", "boundscheck": False, "nogil": True}

_kernels: list[Kernel[Any, Any]] = []
_ready = 0  # how many of these have been handed to numba


class Kernel(Generic[P, R]):
    """A function that numba compiles at its first call. `python` is the function as it was written.

    To call `run` takes half a microsecond less than to call the kernel.

    numba makes machine code of it twice: for other kernels, which take it for `inner`, and, only if Python calls it,
    for Python. What lets Python call a kernel takes longer to compile than many a kernel.
    """

    def __init__(self, python: Callable[P, R], **options: Any) -> None:
        functools.update_wrapper(self, python)
        self.python = python
        self.options = options
        self.run: Callable[P, R] = self._first
        self.inner: Any = None
        _kernels.append(self)

    def _first(self, *args: P.args, **kwargs: P.kwargs) -> R:
        prepare()
        return self.run(*args, **kwargs)

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        return self.run(*args, **kwargs)

    @property
    def _numba_type_(self) -> Any:
        # What numba asks a global of a kernel for.
        from numba import types

        prepare()
        return types.Dispatcher(self.inner)


def kernel(python: Callable[P, R]) -> Kernel[P, R]:
    """Compile this function when it is first called, together with all kernels that it calls."""
    return Kernel(python)


def uncounted(python: Callable[P, R]) -> Callable[P, R]:
    """A kernel that makes no arrays, views of its arguments excepted: numba then leaves out its count of references to
    arrays, two locked instructions for each argument at every call, which would take longer than a small kernel."""
    return Kernel(python, _nrt=False)


def inlined(python: Callable[P, R]) -> Callable[P, R]:
    """An uncounted kernel that becomes part of its callers, before they are compiled: for what is called once in a hot
    loop with many arrays, which take longer to pass than they take to be worked on."""
    return Kernel(python, _nrt=False, inline="always")


def merged(python: Callable[P, R]) -> Callable[P, R]:
    """An uncounted kernel that becomes part of its callers when machine code is made of these: as `inlined`, for what
    is larger, or called in many places, and best compiled once."""
    return Kernel(python, _nrt=False, forceinline=True)


def disabled() -> bool:
    """Whether kernels run as plain Python because NUMBA_DISABLE_JIT asks for it."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


@functools.cache
def compiler() -> Any:
    """The numba module; None if it is missing (a warning says so, once) or disabled."""
    if disabled():
        return None
    try:
        import numba
    except ImportError:
        warnings.warn(
            "numba is not installed: eeca_pymunk runs as plain Python, some hundred times slower; pip install numba",
            stacklevel=4,
        )
        return None
    return numba


@functools.cache
def cache_folder() -> Path:
    """Where machine code of these very sources is kept: beside them, or in the user's cache if that is read-only."""
    digest = hashlib.sha256()
    for source in sorted(_PACKAGE.rglob("*.py")):
        digest.update(source.relative_to(_PACKAGE).as_posix().encode())
        digest.update(source.read_bytes())
    name = f"kernels-{digest.hexdigest()[:16]}"
    beside = _PACKAGE / "__pycache__" / name
    try:
        beside.mkdir(parents=True, exist_ok=True)
        if os.access(beside, os.W_OK):
            return beside
    except OSError:
        pass
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return home / "eeca_pymunk" / name


def prepare() -> None:
    """Hand every kernel to numba, and let the package's modules call the compiled ones directly."""
    global _ready
    if _ready == len(_kernels):
        return
    numba = compiler()
    fresh = _kernels[_ready:]
    _ready = len(_kernels)
    if numba is None:
        for one in fresh:
            # numpy warns of what machine code passes over in silence.
            one.run = np.errstate(all="ignore")(one.python)
        return
    folder = cache_folder()
    if not any(folder.rglob("*.nbi")) and (sys.stderr.isatty() or sys.flags.verbose):
        print("compiling eeca_pymunk's kernels, once", file=sys.stderr)
    before = numba.config.CACHE_DIR
    whole, part = pipelines()
    count_from_the_start()
    try:
        for one in fresh:
            options = {**_OPTIONS, **one.options}
            numba.config.CACHE_DIR = str(folder / "python")
            one.run = numba.njit(**{**options, **whole})(one.python)
            numba.config.CACHE_DIR = str(folder / "kernels")
            one.inner = numba.njit(**{**options, **part}, no_cpython_wrapper=True, no_cfunc_wrapper=True)(one.python)
            one.inner.get_call_template = functools.partial(_called, one.inner.get_call_template, numba.types)
    finally:
        numba.config.CACHE_DIR = before


def _called(template: Callable[..., Any], types: Any, args: tuple[Any, ...], kws: dict[str, Any]) -> Any:
    """numba's answer to a call, asked without literals: a kernel would be compiled again for every constant in a call,
    and for 32-bit integers."""
    wide = tuple(types.int64 if types.unliteral(a) == types.int32 else types.unliteral(a) for a in args)
    return template(wide, {key: types.unliteral(a) for key, a in kws.items()})


def compilations() -> int:
    """Kernels times signatures that numba has compiled, or read from disk, in this process; 0 without numba."""
    dispatchers = [d for one in _kernels for d in (one.run, one.inner)]
    return sum(len(getattr(d, "signatures", ())) for d in dispatchers)
