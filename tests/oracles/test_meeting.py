"""Where features meet: hard cases."""

from __future__ import annotations

import pytest

from comparisons.hard_cases import CASES, Case, meeting

from .running import check, of


@pytest.mark.parametrize("one", of(meeting), ids=lambda one: one.name)
def test_case(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    check(one, monkeypatch)


def test_there_are_as_many_as_the_docs_say() -> None:
    assert len(CASES) == 122
