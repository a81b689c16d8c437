"""Every mutation still fits the sources: what `mutations.py` breaks is there, once."""

from __future__ import annotations

from collections import Counter

from tests.mutations import MUTATIONS, ROOT


def test_mutations_fit_the_sources() -> None:
    found = {one.name: (ROOT / "eeca_pymunk" / one.file).read_text().count(one.old) for one in MUTATIONS}
    assert {name: count for name, count in found.items() if count != 1} == {}


def test_names_are_unique() -> None:
    assert [name for name, count in Counter(one.name for one in MUTATIONS).items() if count > 1] == []
