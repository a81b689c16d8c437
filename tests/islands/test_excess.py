"""Intervals that are cut short give no energy (`islands/excess.py`)."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.contacts.single import move_to
from eeca_pymunk.islands.accounting import close_interval
from eeca_pymunk.model.bodies import Body, Member, Next, Rest
from eeca_pymunk.model.contacts import Impulse, Pair, Pushed
from eeca_pymunk.model.scene import Scene, scene_with
from eeca_pymunk.model.shapes import Link

G, SPEED = 10.0, 2.0


def landing() -> Scene:
    """Body 0, of mass 1, rises from a floor with SPEED and falls back: in an interval of 2 SPEED / G + 1 a contact
    brings it to rest at its end, with a constant force from the start on."""
    h = 2.0 * SPEED / G + 1.0
    body, pushed = rows(Body, 2), rows(Pushed, 1)
    impulse = G * h - SPEED  # to end with velocity 0
    body[0].inv_mass, body[0].vy, body[0].ay = 1.0, SPEED, -SPEED / h
    R = pushed[0]
    R.normal, R.un_before, R.length, R.ny = impulse, SPEED, h, 1.0
    by, link, member = rows(Pair, 1), rows(Link, 2), rows(Member, 2)
    by[0].root, by[0].a, by[0].b = 0, 1, 0
    link[0].owner, link[1].owner = 0, 1
    member[0].following, member[0].bodies, member[0].open = -1, 1, 1
    scene = scene_with(
        BODY=body, PUSHED=pushed, PUSHED_BY=by, LINK=link, MEMBER=member, STATE=rows(Next, 2), RESTING=rows(Rest, 2),
        PULL=np.array([[0.0, -G, 0.0], [0.0, 0.0, 0.0]]), LOG=rows(Impulse, 4),
    )  # fmt: skip
    scene.COUNT.pushes, scene.PAR.dt = 1, h
    return scene


@pytest.mark.parametrize("ahead", [0.0, 0.1, 0.2])
def test_an_interval_cut_short_gives_no_energy_wherever_its_path_was_looked_at(ahead: float) -> None:
    """The body still rises where the interval is cut, so the force until there has given energy: it is taken away, and
    the body flies as without it, v = SPEED - G t. That gaps were looked at at an earlier instant changes nothing."""
    scene, t = landing(), 0.3
    move_to(scene.BODY, 0, ahead)
    close_interval(scene, 0, t)
    body = scene.BODY[0]
    assert scene.PAR.restitution + scene.PAR.frictional >= 0.0
    assert body.vy == pytest.approx(SPEED - G * t, abs=1e-14)
    assert body.y == pytest.approx(SPEED * t - 0.5 * G * t * t, abs=1e-14)


def test_bodies_that_no_force_connects_with_it_keep_their_forces() -> None:
    """Body 1 of the same island rests on the floor: with the part of its force that the flight of body 0 leaves it
    would be 0.45 m deep."""
    one, t = landing(), 0.3
    body, pushed, by, link, member = rows(Body, 3), rows(Pushed, 2), rows(Pair, 2), rows(Link, 3), rows(Member, 3)
    body[0], pushed[0], by[0], link[0] = one.BODY[0], one.PUSHED[0], one.PUSHED_BY[0], one.LINK[0]
    body[1].inv_mass = 1.0
    R = pushed[1]
    R.normal, R.length, R.ny = G * one.PAR.dt, one.PAR.dt, 1.0
    by[0].b, by[0].a, by[1].b, by[1].a = 0, 2, 1, 2
    link[1].owner, link[2].owner = 1, 2
    member[0].following, member[0].bodies, member[0].open, member[1].following = 1, 2, 1, -1
    scene = scene_with(
        BODY=body, PUSHED=pushed, PUSHED_BY=by, LINK=link, MEMBER=member, STATE=rows(Next, 3), RESTING=rows(Rest, 3),
        PULL=np.array([[0.0, -G, 0.0], [0.0, -G, 0.0], [0.0, 0.0, 0.0]]), LOG=rows(Impulse, 4),
    )  # fmt: skip
    scene.COUNT.pushes, scene.PAR.dt = 2, one.PAR.dt
    close_interval(scene, 0, t)
    assert (scene.BODY[1].y, scene.BODY[1].vy) == (0.0, 0.0)
    assert scene.BODY[0].y == pytest.approx(SPEED * t - 0.5 * G * t * t, abs=1e-14)
    assert scene.PAR.restitution + scene.PAR.frictional >= 0.0
