"""`python -m eeca_pymunk` prints the versions on which results depend, how kernels run (library, JIT or plain Python),
and why."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

from .compiled.backend import Backend, choose
from .recorder import versions

_DESCRIPTIONS = {
    "library": "library",
    "jit": "compiled for this processor, at the first step",
    "python": "plain Python, some hundred times slower",
}


def lines() -> list[str]:
    """The lines that are printed."""
    try:
        numba = version("numba")
    except PackageNotFoundError:
        numba = "not installed"
    numbers = versions() | {"numba": numba}
    return [f"{name:12} {number}" for name, number in numbers.items()] + [f"{'kernels':12} {_kernels(choose(False))}"]


def _kernels(backend: Backend) -> str:
    return f"{_DESCRIPTIONS[backend.kind]}: {backend.why}"


if __name__ == "__main__":
    print("\n".join(lines()))
