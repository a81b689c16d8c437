"""What stands, stands still; what cannot stand falls; forces at rest are weights."""

from __future__ import annotations

import pytest

from comparisons.hard_cases import Case, piles, reports

from .running import check, of


@pytest.mark.parametrize("one", of(piles, reports), ids=lambda one: one.name)
def test_case(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    check(one, monkeypatch)
