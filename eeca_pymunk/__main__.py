"""`python -m eeca_pymunk`: versions on which results depend, the code that kernels run, and the reason."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

from .compiled.backend import Backend, choose
from .recorder import versions

_SAYS = {
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
    found = versions() | {"numba": numba}
    return [f"{name:12} {number}" for name, number in found.items()] + [f"{'kernels':12} {_kernels(choose(False))}"]


def _kernels(backend: Backend) -> str:
    return f"{_SAYS[backend.kind]}: {backend.why}"


if __name__ == "__main__":
    print("\n".join(lines()))
