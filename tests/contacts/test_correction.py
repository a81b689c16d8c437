"""What the penetration correction costs (`contacts/correction.py`)."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.contacts.correction import correct_penetration
from eeca_pymunk.contacts.works import kinetic_energy
from eeca_pymunk.model.contacts import Problem, Row
from eeca_pymunk.model.parameters.intervals import OVERLAP_LEFT


@pytest.mark.parametrize("budget", [1e-3, 0.03, 0.1, 0.3, 0.5])
def test_it_costs_what_it_may_where_a_common_rotation_keeps_the_angular_momentum(budget: float) -> None:
    """Two bodies about each other, which turn the other way, are moved apart: this adds p g to their angular momentum,
    and the rotation that takes it out costs p g (-L) / I - (p g)^2 / (2 I), by I as it is then. With the parts of the
    whole displacement as parts of its cost, that was up to 1.02 of the budget."""
    ROWS, IM, II = rows(Row, 1), np.ones(2), np.full(2, 1.0 / 0.3)
    ROWS[0].a, ROWS[0].b, ROWS[0].nx, ROWS[0].gap, ROWS[0].k_n, ROWS[0].a_nn = 0, 1, 1.0, -0.2, 0.5, 2.0
    POSE, V = np.array([[-0.4, 0.0, 0.0], [0.4, 0.0, 0.0]]), np.array([[0.0, -1.0, -10.0], [0.0, 1.0, -10.0]])
    JUMP = np.zeros((2, 6))
    problem, L, extent = Problem(ROWS, IM, II, POSE, 2, 1), np.zeros((1, 2)), np.full(2, 0.5)
    correct_penetration(problem, L, POSE, V, np.zeros((2, 3)), 0.0, extent, budget, OVERLAP_LEFT, JUMP)
    before, after = kinetic_energy(V, IM, II, 2), kinetic_energy(V + JUMP[:, 3:], IM, II, 2)
    assert 0.97 * budget <= after - before <= budget
    NEW, W = POSE + JUMP[:, :3], V + JUMP[:, 3:]
    turning = [
        sum(x * v - y * u + 0.3 * w for (x, y, _), (u, v, w) in zip(P, Q, strict=True))
        for P, Q in ((POSE, V), (NEW, W))
    ]
    assert turning[1] == pytest.approx(turning[0], rel=1e-14)


def test_bodies_that_press_on_nobody_do_not_turn_with_others() -> None:
    """The two of the test above, and two beside them that are apart and touch nobody: these keep their velocities."""
    ROWS, IM, II = rows(Row, 2), np.ones(4), np.full(4, 1.0 / 0.3)
    for z, gap in enumerate((-0.2, 1.0)):
        ROWS[z].a, ROWS[z].b, ROWS[z].nx, ROWS[z].gap, ROWS[z].k_n, ROWS[z].a_nn = 2 * z, 2 * z + 1, 1.0, gap, 0.5, 2.0
    POSE = np.array([[-0.4, 0.0, 0.0], [0.4, 0.0, 0.0], [5.0, 0.0, 0.0], [7.0, 0.0, 0.0]])
    V = np.array([[0.0, -1.0, -10.0], [0.0, 1.0, -10.0], [0.0, 3.0, 0.0], [1.0, 0.0, 2.0]])
    JUMP, extent = np.zeros((4, 6)), np.full(4, 0.5)
    correct_penetration(
        Problem(ROWS, IM, II, POSE, 4, 2), np.zeros((2, 2)), POSE, V, np.zeros((4, 3)), 0.0, extent, 0.5, OVERLAP_LEFT,
        JUMP,
    )  # fmt: skip
    assert abs(JUMP[:2, 4]).min() > 0.0
    assert not JUMP[2:].any()
