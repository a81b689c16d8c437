"""The numbers chosen for results or costs of a compiled step, with kind, scale and effect (`record.Parameter`).

In: nothing. Out: plain numbers, which kernels import by name and the compiler treats as constants; `table()` for docs
and ablations. Open `rest.py` first. Guards against round-off, sizes of memory and statuses are no parameters and stand
where they are used; `Dashpot` and the baselines have their parameters in their own files.
"""

from __future__ import annotations

from . import detection, events, impulses, intervals, joints, rest
from .record import DECLARED, Parameter

SECTIONS = detection, events, impulses, intervals, joints, rest


def table() -> dict[str, dict[str, Parameter]]:
    """The parameters of each section by name, in the order of its file."""
    declared, found = iter(DECLARED), {}
    for section in SECTIONS:
        names = [name for name in vars(section) if name.isupper()]
        found[section.__name__.rpartition(".")[2]] = dict(zip(names, declared, strict=False))
    return found
