"""`python -m eeca_pymunk`: versions of what results depend on, and whether the kernels are compiled."""

from __future__ import annotations

import os
import warnings
from importlib.metadata import PackageNotFoundError, version

from .compiled import cache_folder, compiler, disabled
from .recording import versions


def lines() -> list[str]:
    """What is printed."""
    try:
        numba = version("numba")
    except PackageNotFoundError:
        numba = "not installed"
    found = versions() | {"numba": numba}
    return [f"{name:12} {number}" for name, number in found.items()] + [f"{'kernels':12} {_kernels()}"]


def _kernels() -> str:
    if disabled():
        return f"plain Python, as NUMBA_DISABLE_JIT={os.environ['NUMBA_DISABLE_JIT']} asks for"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # this line says it
        if compiler() is None:
            return "plain Python, some hundred times slower: pip install numba"
    folder = cache_folder()
    if any(folder.rglob("*.nbi")):
        return f"compiled; machine code is kept in {folder}"
    return f"compiled at the first step, which takes minutes once (eeca_pymunk.warmup() does it now); kept in {folder}"


if __name__ == "__main__":
    print("\n".join(lines()))
