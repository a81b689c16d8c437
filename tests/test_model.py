"""Model only what a scene needs: every part is absent where the scene lacks it, and present where it has it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
import scenes
from eeca_pymunk import array_stepper
from eeca_pymunk._rounds import impact_times
from eeca_pymunk._rounds.blocks import Blocks
from eeca_pymunk._rounds.forecast import Pairs
from eeca_pymunk._rounds.impacts import Impacts
from scenes.scene import add_disk, add_walls


def space(gravity: float = 0.0, elasticity: float = 1.0, spin: float = 0.0, touching: bool = False) -> pymunk.Space:
    """A disk that meets the floor within a step of .1 s, or rests on it."""
    result = pymunk.Space()
    result.gravity = (0.0, -gravity)
    disk = add_disk(result, (0.0, 0.1 if touching else 0.15), 0.1, velocity=(0.0, 0.0 if touching else -1.0))
    disk.angular_velocity = spin
    next(iter(disk.shapes)).elasticity = elasticity
    add_walls(result, [((-1.0, 0.0), (1.0, 0.0))])
    return result


PARTS: dict[str, tuple[object, str, dict[str, float], str, str]] = {
    "rotation": (array_stepper, "turn", {"spin": 1.0}, "no rotation", "free rotation"),
    "loss": (Impacts, "stays", {"elasticity": 0.5}, "elastic", "loss"),
    "forces": (Blocks, "_rest", {"gravity": 9.81, "touching": True}, "no forces", "gravity or forces"),
}


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())
def test_part_is_there_only_where_needed(
    part: tuple[object, str, dict[str, float], str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    owner, name, needs, without, having = part
    calls: list[str] = []
    original: Callable[..., object] = getattr(owner, name)
    monkeypatch.setattr(owner, name, lambda *args: (calls.append(name), original(*args))[1])
    plain = ep.EECA(space())
    assert len(plain.step(0.1).contacts) == 1
    assert not calls
    assert without in plain.model
    scene = ep.EECA(space(**needs))  # type: ignore[arg-type]
    assert having in scene.model
    scene.step(0.1)
    assert calls


@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_gravity_terms_of_times_of_impact(gravity: float, monkeypatch: pytest.MonkeyPatch) -> None:
    pulls: list[object] = []
    flat = impact_times.flat
    monkeypatch.setattr(impact_times, "flat", lambda h, w, alpha: (pulls.append(alpha), flat(h, w, alpha))[1])
    ep.EECA(space(gravity)).step(0.1)
    assert pulls
    assert all(isinstance(alpha, float) and alpha == 0.0 for alpha in pulls) == (gravity == 0.0)


def test_no_detection_and_no_forecast_where_nothing_is_near(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scenes.build("carom", dt=1e-4)
    stepper = ep.EECA(scene.space)
    stepper.step(1e-4)
    assert stepper._twin is not None
    detections = stepper._twin.detections
    monkeypatch.setattr(Pairs, "between", lambda *args: pytest.fail("geometry of a pair"))
    for _ in range(3):
        stepper.step(1e-4)
    assert stepper._twin.detections == detections


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
