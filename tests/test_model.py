"""Model only what a scene needs: every part is absent where the scene lacks it, and present where it has it."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
import scenes
from eeca_pymunk.impacts.scene import EventLoop
from scenes.scene import add_disk, add_walls


def space(
    gravity: float = 0.0, elasticity: float = 1.0, spin: float = 0.0, friction: float = 0.0, touching: bool = False
) -> pymunk.Space:  # fmt: skip
    """A disk that meets the floor within a step of .1 s, or rests on it."""
    result = pymunk.Space()
    result.gravity = (0.0, -gravity)
    disk = add_disk(result, (0.0, 0.1 if touching else 0.15), 0.1, velocity=(0.0, 0.0 if touching else -1.0))
    disk.angular_velocity = spin
    add_walls(result, [((-1.0, 0.0), (1.0, 0.0))])
    next(iter(disk.shapes)).elasticity = elasticity
    for shape in result.shapes:
        shape.friction = friction
    return result


@pytest.mark.parametrize(
    ("needs", "having", "without"),
    [
        ({"spin": 1.0}, "free rotation", "no rotation"),
        ({"elasticity": 0.5}, "loss", "elastic"),
        ({"gravity": 9.81}, "gravity or forces", "no forces"),
        ({"friction": 0.5}, "friction", "friction"),
    ],
)
def test_model_names_a_part_only_where_it_is_needed(needs: dict[str, float], having: str, without: str) -> None:
    plain, scene = ep.EECA(space()).model, ep.EECA(space(**needs)).model  # type: ignore[arg-type]
    assert having in scene
    assert having not in plain
    assert (without in plain) == (without != having)


def test_islands_are_solved_only_where_something_rests() -> None:
    hit = ep.EECA(space()).step(0.1)
    assert len(hit.contacts) == 1
    assert hit.iterations == 0  # the closed law of one impact
    assert ep.EECA(space(gravity=9.81, elasticity=0.0, touching=True)).step(0.1).iterations == 1


def test_no_list_and_no_forecast_is_made_where_nothing_is_near() -> None:
    scene = scenes.build("carom", dt=1e-4)
    stepper = ep.EECA(scene.space)
    stepper.step(1e-4)
    method = stepper._method
    assert isinstance(method, EventLoop)
    lists = method.scene.GRID.renewals
    for _ in range(3):
        stepper.step(1e-4)
        assert method.scene.COUNT.work == 0
    assert method.scene.GRID.renewals == lists


def test_model_is_one_line_for_every_stepper() -> None:
    for stepper in (ep.Native(space()), ep.Newmark.trapezoidal(space(), 1e6), ep.EECA(space(9.81, 0.5, 1.0))):
        assert stepper.model
        assert "\n" not in stepper.model
    assert ep.EECA(space()).model == "1 disks, 1 walls; no forces; no rotation; elastic"


def test_model_follows_the_space() -> None:
    s = space()
    (body,) = s.bodies
    stepper = ep.EECA(s)
    s.gravity = (0.0, -1.0)
    body.torque = 1.0
    assert "gravity or forces; free rotation" in stepper.model
    stepper.step(1e-3)
    assert body.angle == pytest.approx(0.5 * 1e-6 / body.moment, rel=1e-9)
    assert np.isfinite(body.position.y)
