"""Some random programs of API calls; `python -m tests.programs.soak` runs ten thousand."""

from __future__ import annotations

from collections.abc import Callable

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from .fuzz import Program


# Without shrinking, which would take minutes: the soak does it.
@settings(
    max_examples=120, deadline=None, derandomize=True, database=None, phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)  # fmt: skip
@given(st.data())
def test_random_programs(data: st.DataObject) -> None:
    draw: Callable[..., object] = data.draw
    Program(draw).play(25)
