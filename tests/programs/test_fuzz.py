"""Some random programs of API calls; `python -m tests.programs.soak` runs ten thousand."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from .fuzz import Drawn, Program, Thrown


# Without shrinking, which would take minutes: the soak does it.
@settings(
    max_examples=120, deadline=None, derandomize=True, database=None, phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)  # fmt: skip
@given(st.data())
def test_random_programs(data: st.DataObject) -> None:
    Program(Drawn(data)).play(25)


@pytest.mark.parametrize("first", range(0, 400, 40))
def test_random_programs_with_joints(first: int) -> None:
    for seed in range(first, first + 40):
        chance = Thrown(seed)
        try:
            Program(chance, joints=True).play(40)
        except Exception as error:
            error.add_note(f"seed {seed}: {' '.join(chance.calls)}")
            raise
