"""What a step notes of budgets and tolerances that it has not met, and the work of its solves."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.contacts.counts import count_solve, note_unmet
from eeca_pymunk.model.contacts import Solved
from eeca_pymunk.model.parameters.events import DIRECT_LOOKS, OPERATION_LOOKS, SWEEP_LOOKS
from eeca_pymunk.model.step import CONTACTS, SOLVES, Count, Missed


def test_why_a_step_ended_early_is_noted_after_others_have_filled_the_room() -> None:
    scene: Any = SimpleNamespace(COUNT=rows(Count, 1)[0], MISSED=rows(Missed, 3))
    for k in range(5):
        note_unmet(scene, CONTACTS, k, k + 1, float(k), 0.5)
    assert scene.MISSED["first"].tolist() == [0, 1, 2]
    note_unmet(scene, SOLVES, 7, -1, 9.0, 8.0)
    assert scene.COUNT.unmet == 6
    assert scene.MISSED["kind"].tolist() == [CONTACTS, CONTACTS, SOLVES]
    assert (scene.MISSED[2].first, scene.MISSED[2].second) == (7, -1)
    assert (scene.MISSED[2].value, scene.MISSED[2].limit) == (9.0, 8.0)


@pytest.mark.parametrize("times", [1, 1000])
@pytest.mark.parametrize(
    ("field", "amount", "looks"),
    [("sweeps", 1, 3 * SWEEP_LOOKS), ("direct", 1, 9 * DIRECT_LOOKS), ("operations", 1.0, OPERATION_LOOKS)],
)
def test_what_a_solve_has_taken_is_work_of_the_step(field: str, amount: float, looks: float, times: int) -> None:
    """Sweeps of three contacts, direct solutions, which are dense, and homotopies; of many small solves too."""
    work = []
    for taken in (0, amount):
        scene: Any = SimpleNamespace(COUNT=rows(Count, 1)[0])
        out = rows(Solved, 1)
        setattr(out[0], field, taken)
        for _ in range(times):
            count_solve(scene, 1, 1, 3, out)
        work.append(float(scene.COUNT.work))
    assert work[1] - work[0] == pytest.approx(looks * amount * times, rel=1e-9)
