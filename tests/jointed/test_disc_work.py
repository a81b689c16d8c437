"""The work of forces that are bounded by a disc counts: sweeps over them may take most of the time of a step."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.jointed.solve import try_interval
from eeca_pymunk.model.contacts import Bounded
from eeca_pymunk.model.joints import Joints
from eeca_pymunk.model.scene import Scene
from eeca_pymunk.newton import boxes
from eeca_pymunk.rows import bounded, columns, laws


def dragged(floor: bool, h: float) -> tuple[Scene, Joints]:
    """A body that a pivot of bounded force drags, its row is 0, before an interval h."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    body = pymunk.Body(1.0, 1.0)
    body.position, body.velocity = (0.0, 0.5), (3.0, 0.0)
    box = pymunk.Poly.create_box(body, (1.0, 1.0))
    pivot = pymunk.PivotJoint(space.static_body, body, (0.0, 0.5))
    pivot.max_force, box.friction = 2.0, 0.5
    space.add(body, box, pivot)
    if floor:
        ground = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
        ground.friction = 0.5
        space.add(ground)
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    A.PAR.dt = A.PAR.planned = h
    A.BODY[0].since = J.PROGRESS.effort = 0.0
    return A, J


@pytest.mark.parametrize("floor", [False, True])
def test_each_sweep_over_a_disc_is_work(monkeypatch: pytest.MonkeyPatch, floor: bool) -> None:
    """In the air, and on a floor, where contacts are solved with it."""
    h, alone, with_contacts, efforts = 0.01, [], [], []
    sweep, sweep_both = boxes.sweep_boxes, bounded.sweep_bounded

    def in_boxes(more: FloatArray, w: int, u: int, n: int) -> float:
        alone.append(n)
        return sweep(more, w, u, n)

    def in_columns(B: Bounded, L: FloatArray, m: int, V: FloatArray) -> float:
        with_contacts.append(m)
        return sweep_both(B, L, m, V)

    for work in (0.0, 1e3):
        A, J = dragged(floor, h)
        monkeypatch.setattr(boxes, "DISC_WORK", work)
        monkeypatch.setattr(laws, "DISC_WORK", work)
        monkeypatch.setattr(boxes, "sweep_boxes", in_boxes)
        monkeypatch.setattr(columns, "sweep_bounded", in_columns)
        alone.clear()
        with_contacts.clear()
        assert try_interval(A, J, A.STATE[0].island, 0.0, h, True)[0] == 0
        efforts.append(float(J.PROGRESS.effort))
    assert len(alone) > 0
    assert (len(with_contacts) > 0) == floor
    assert efforts[1] - efforts[0] == pytest.approx(1e3 * (len(alone) + len(with_contacts)))
