"""What a step notes of budgets and tolerances that it has not met."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.contacts.counts import note_unmet
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
