"""Parts of pymunk's API that no other test is about: copies, threads, settings that are not used, what is not felt."""

from __future__ import annotations

import gc
from collections.abc import Callable

import pymunk
import pytest
from pymunk import ContactPointSet

import eeca_pymunk as ep
from scenes.scene import add_disk

from ..steppers import state
from .test_idioms import Make, both, box_on, ground, run


@both
def test_copies_of_a_body_a_shape_and_a_joint_go_as_their_originals(make: Make) -> None:
    """Programs build one thing and copy it; also one that has been stepped."""
    ends = []
    for copied in (False, True):
        space, _ = ground()
        stepper, template = make(space), box_on(space, 0.0, 3.0)
        (shape,) = template.shapes
        joint = pymunk.PinJoint(space.static_body, template, (0.0, 4.0), (0.2, 0.0))
        space.add(joint)
        run(stepper, 5)
        if copied:
            gc.disable()  # a copied shape does not keep its body, which only a cycle of references does
            twin, chained = shape.copy(), joint.copy()
            kept = twin.body
            gc.enable()
            assert {one.space for one in (twin, twin.body, chained.b, template.copy())} == {None}
            space.remove(template, shape, joint)
            assert twin.body is not None
            assert twin.body is kept
            space.add(twin, twin.body)
            template, joint = twin.body, chained
        else:
            space.remove(joint)
        space.add(pymunk.PinJoint(space.static_body, template, joint.anchor_a, joint.anchor_b))
        run(stepper, 40)
        ends.append(state(space)[1:])
    assert ends[1] == [pytest.approx(one, abs=1e-12) for one in ends[0]]


def test_threads_change_nothing() -> None:
    ends, seen = [], []
    for threaded in (False, True):
        space = pymunk.Space(threaded=threaded)
        space.threads = 2
        space.gravity = (0.0, -10.0)
        space.add(pymunk.Segment(space.static_body, (-50.0, 0.0), (50.0, 0.0), 0.1))
        bodies = [box_on(space, 0.1 * k, 1.0 + 1.2 * k) for k in range(20)]
        calls: list[int] = []
        space.on_collision(post_solve=lambda *_, calls=calls: calls.append(len(calls)))
        stepper = ep.EECA(space)
        for _ in range(60):
            stepper.step(1 / 60)
            for body in bodies:
                found = space.point_query_nearest(body.position, 0.0, pymunk.ShapeFilter())
                assert found is not None
                assert found.shape is not None
                assert found.shape.body is body
        assert calls
        ends.append(state(space))
        seen.append(len(calls))
    assert ends[0] == ends[1]
    assert seen[0] == seen[1]


UNUSED: dict[str, tuple[str, float]] = {
    name: (name, value)
    for name, value in (
        ("iterations", 1), ("collision_slop", 0.4), ("collision_bias", 0.9), ("collision_persistence", 30),
        ("idle_speed_threshold", 9.0),
    )
}  # fmt: skip


@pytest.mark.parametrize(("name", "value"), UNUSED.values(), ids=UNUSED.keys())
def test_settings_of_pymunks_solver_are_kept_and_not_used(name: str, value: float) -> None:
    ends = []
    for chosen in (None, value):
        space, _ = ground()
        for k in range(4):
            box_on(space, 0.1 * k, 0.7 + 1.2 * k)
        if chosen is not None:
            setattr(space, name, chosen)
        run(ep.EECA(space), 80)
        assert chosen is None or getattr(space, name) == pytest.approx(chosen)
        ends.append(state(space)[1:])
    assert ends[0] == ends[1]


def shifted(points: ContactPointSet) -> None:
    points.normal = pymunk.Vec2d(1.0, 0.0)


def deeper(points: ContactPointSet) -> None:
    for point in points.points:
        point.distance = -5.0


@pytest.mark.parametrize("change", [shifted, deeper])
def test_contact_points_set_in_pre_solve_are_not_felt(change: Callable[[ContactPointSet], None]) -> None:
    space = pymunk.Space()
    ball = add_disk(space, (0.0, 1.0), 0.1, velocity=(0.5, -3.0))
    wall = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
    wall.elasticity = 1.0
    space.add(wall)
    seen: list[pymunk.Vec2d] = []

    def meddle(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        points = arbiter.contact_point_set
        seen.append(points.normal)
        change(points)
        arbiter.contact_point_set = points

    space.on_collision(pre_solve=meddle)
    run(ep.EECA(space), 60)
    assert seen[0] == pytest.approx((0.0, -1.0))
    assert ball.velocity == pytest.approx((0.5, 3.0))
