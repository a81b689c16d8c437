"""Hard cases of a kind, as tests: in their short form, each step's ledger looked at."""

from __future__ import annotations

import types

import pytest

from comparisons import hard_cases
from comparisons.hard_cases import CASES, Case

from .audit import Audit, auditor

SHORT = {
    "crowd": 300, "720-gon": 300, "stick": 5000, "pyramid": 60, "pyramid rows": 12, "random scenes": 60,
    "random impacts": 300, "resting": 1200,
}  # fmt: skip
ROUND_OFF = 1e-12  # of the energy scale of a step


def of(*kinds: types.ModuleType) -> list[Case]:
    """The cases of some files."""
    return [one for one in CASES if one.run.__module__ in {kind.__name__ for kind in kinds}]


def check(one: Case, patch: pytest.MonkeyPatch, *, audit: bool = True) -> None:
    """The figure is within its limit; every ledger closes, and no loss is negative."""
    for name, count in SHORT.items():
        patch.setitem(hard_cases.LONG, name, count)
    made: list[Audit] = []
    found = hard_cases.figure(one, auditor(made))
    assert found is not None
    assert found <= one.limit
    if audit:
        assert max((a.residual for a in made), default=0.0) <= ROUND_OFF
        assert min((a.loss for a in made), default=0.0) >= -ROUND_OFF
