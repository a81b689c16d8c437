"""Newton's method begins with the factors of the component's last motion in an interval (`Progress.kept`), and with no
others: what earlier intervals have left in the scratch changes nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pymunk
import pytest

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.jointed import component
from eeca_pymunk.jointed.contact_laws import set_aims
from eeca_pymunk.joints.workspace import workspace
from eeca_pymunk.model.joint_steps import STEP as STEP_OF
from eeca_pymunk.model.joint_steps import Agreement
from eeca_pymunk.model.joints import OTHERWISE
from eeca_pymunk.model.parameters import joints as parameters
from eeca_pymunk.newton import solve
from eeca_pymunk.newton.systems import assemble, first_iterate

from .test_work import STEP, box_with, interval, with_arms


def solved(monkeypatch: pytest.MonkeyPatch, before: Any = None, left: float = 0.0) -> tuple[int, int, np.ndarray]:
    """An interval of a box with arms on a floor: how often a matrix is factored, how many motions there are, and the
    velocities at the end with the operations that this took.

    Args:
        before: what is done to the joints before each motion.  left: entries of a matrix of an earlier interval, 0 for
            none.
    """
    counts, motion, factor = [0, 0], component.take_step, solve.factorise

    def moved(W: Any, *given: Any) -> int:
        counts[1] += 1
        if before is not None:
            before(W.J)
        return motion(W, *given)

    def factored(*given: Any) -> int:
        counts[0] += 1
        return factor(*given)

    A, J = box_with(with_arms, True)
    for joint in J.JOINT:
        joint.touched, joint.last_step = 0, 0.0  # impulses and accelerations of a step of 1e-9 s are no guess
        joint.led[:] = 0.0
    J.MATRIX[:], J.PROGRESS.factors_of = left, int(left > 0.0)
    with monkeypatch.context() as patched:
        patched.setattr(component, "take_step", moved)
        patched.setattr(solve, "factorise", factored)
        interval(A, J)
    return counts[0], counts[1], np.array([*((b.vx, b.vy, b.spin) for b in A.BODY[:6]), (J.PROGRESS.effort, 0.0, 0.0)])


def test_motions_of_an_interval_share_their_factors(monkeypatch: pytest.MonkeyPatch) -> None:
    def forget(J: Any) -> None:
        J.PROGRESS.factors_of = 0

    few, motions, V = solved(monkeypatch)
    many, same, W = solved(monkeypatch, forget)
    assert few < motions == same <= many
    assert np.abs(V[:-1]).max() > 1.0
    np.testing.assert_allclose(V[:-1], W[:-1], rtol=0.0, atol=1e-12)


def test_factors_of_an_earlier_interval_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    few, motions, V = solved(monkeypatch)
    same, again, W = solved(monkeypatch, left=1e3)
    assert (few, motions) == (same, again)
    np.testing.assert_array_equal(V, W)


def test_factors_are_not_those_of_a_limit_that_acts_since() -> None:
    def on_a_rope(space: pymunk.Space, body: pymunk.Body) -> None:
        space.add(pymunk.SlideJoint(space.static_body, body, (0.0, 5.0), (0.0, 0.0), 0.0, 4.6))

    J = box_with(on_a_rope, False)[1]
    W, system = workspace(J, 0), int(J.COMPONENT[0].system)
    for side, fits in ((0, True), (1, False)):
        W.link[0].side = side
        first_iterate(W, STEP_OF, STEP)
        assemble(W, STEP_OF, STEP, 0.0, True, system, side == 0)
        if side == 0:
            J.COMPONENT[0].factored = 1
        assert (J.COMPONENT[0].factored != OTHERWISE) == fits


@pytest.mark.parametrize(("slow", "rests"), [(0.05, True), (0.5, False), (5.0, False)])
def test_only_what_hardly_moves_is_near_rest(slow: float, rests: bool) -> None:
    """Beside motors that would give an island the speed 1 in an interval."""
    S = rows(Agreement, 1)[0]
    S.slow, S.fast, S.pull = slow, slow, 1.0 / STEP
    set_aims(S, STEP, False)
    assert S.scale == pytest.approx(1.0 + slow)
    assert S.agree == pytest.approx((parameters.AGREE_REST if rests else parameters.AGREE) * S.scale)
