"""Intervals that are cut short give no energy (`islands/excess.py`)."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.contacts.single import move_to
from eeca_pymunk.islands.accounting import close_interval
from eeca_pymunk.islands.excess import losses, repay
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


def above(count: int) -> Scene:
    """`landing` of body 0 on so many others of mass 1 which rest on each other and on the floor; with 0, beside one
    that rests on the floor. All that pushes body 0 pushes what is below it down."""
    one, n = landing(), max(count, 1) + 1
    body, pushed, by, link, member = (
        rows(Body, n + 1),
        rows(Pushed, n),
        rows(Pair, n),
        rows(Link, n + 1),
        rows(Member, n),
    )
    body[0], pushed[0], h = one.BODY[0], one.PUSHED[0], one.PAR.dt
    pull = np.zeros((n + 1, 3))
    pull[:n, 1] = -G
    for i in range(n):
        link[i].owner, member[i].following = i, i + 1 if i + 1 < n else -1
        by[i].b, by[i].a = i, i + 1 if count > 0 or i + 1 == n else n
        if i > 0:
            body[i].inv_mass, R = 1.0, pushed[i]
            R.normal, R.length, R.ny = i * G * h + (pushed[0].normal if count > 0 else 0.0), h, 1.0
    link[n].owner, member[0].bodies, member[0].open = n, n, 1
    scene = scene_with(
        BODY=body, PUSHED=pushed, PUSHED_BY=by, LINK=link, MEMBER=member, STATE=rows(Next, n + 1),
        RESTING=rows(Rest, n + 1), PULL=pull, LOG=rows(Impulse, n),
    )  # fmt: skip
    scene.COUNT.pushes, scene.PAR.dt = n, h
    return scene


@pytest.mark.parametrize("count", [0, 1])
def test_what_bears_a_load_keeps_its_force(count: int) -> None:
    """Body 1 of the same island rests on the floor, under body 0 or beside it: without a force of the floor it would be
    0.45 m deep, with what it bore of body 0 it would be lifted."""
    scene, t = above(count), 0.3
    close_interval(scene, 0, t)
    assert abs(scene.BODY[1].y) < 1e-14
    assert abs(scene.BODY[1].vy) < 1e-13
    assert scene.BODY[0].y == pytest.approx(SPEED * t - 0.5 * G * t * t, abs=1e-14)
    assert scene.PAR.restitution + scene.PAR.frictional >= 0.0


def test_what_sweeps_leave_gives_no_energy() -> None:
    """Twenty sweeps are too few for a tower of thirty bodies that all bear less. What it has lost of kinetic and
    potential energy is what is booked, and none of it is below 0."""
    scene, t, count = above(30), 0.3, 30
    close_interval(scene, 0, t)
    lost = scene.PAR.restitution + scene.PAR.frictional
    held = sum(0.5 * b.vy * b.vy + G * b.y for b in scene.BODY[: count + 1])
    assert held + lost == pytest.approx(0.5 * SPEED * SPEED, abs=1e-12)
    assert lost >= -1e-12


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("seed", range(5))
def test_random_impulses_give_nothing_and_keep_momentum(seed: int, size: float) -> None:
    """Eight free bodies with twelve contacts of any impulses: up to the cut kinetic energy is what it was, less the
    losses that are booked, which are none below 0; momentum is what it was."""
    rng = np.random.default_rng(seed)
    n, m, h, t = 8, 12, 1.0, 0.3
    body, pushed, by, link, member = rows(Body, n + 1), rows(Pushed, m), rows(Pair, m), rows(Link, n), rows(Member, n)
    mass, inertia = rng.uniform(0.1, 10.0, n), size * size * rng.uniform(0.1, 10.0, n)
    before = size * rng.normal(size=(n, 2))
    after = before.copy()
    spin, turned = rng.normal(size=n), np.zeros(n)
    for i in range(n):
        body[i].inv_mass, body[i].inv_inertia = 1.0 / mass[i], 1.0 / inertia[i]
        (body[i].vx, body[i].vy), body[i].spin = before[i], spin[i]
        link[i].owner, member[i].following = i, i + 1 if i + 1 < n else -1
    member[0].bodies, member[0].open = n, 1
    turned += spin
    pairs = [rng.choice(n, 2, replace=False) for _ in range(m)]
    for c, (a, b) in enumerate(pairs):
        R, angle, arm = pushed[c], rng.uniform(0.0, 2.0 * np.pi), size * rng.normal(size=4)
        R.nx, R.ny, R.length = np.cos(angle), np.sin(angle), h
        R.normal, R.tangential = size * rng.uniform(0.0, 3.0), size * rng.normal()
        R.arm_na, R.arm_nb, R.arm_ta, R.arm_tb = arm
        force = R.normal * np.array([R.nx, R.ny]) + R.tangential * np.array([-R.ny, R.nx])
        after[a] -= force / mass[a]
        after[b] += force / mass[b]
        turned[a] -= (R.normal * R.arm_na + R.tangential * R.arm_ta) / inertia[a]
        turned[b] += (R.normal * R.arm_nb + R.tangential * R.arm_tb) / inertia[b]
        by[c].a, by[c].b = a, b
    for c, (a, b) in enumerate(pairs):
        R = pushed[c]
        for v, w, name in ((before, spin, "before"), (after, turned, "after")):
            x, y = v[b] - v[a]
            setattr(R, f"un_{name}", R.nx * x + R.ny * y + R.arm_nb * w[b] - R.arm_na * w[a])
            setattr(R, f"ut_{name}", R.nx * y - R.ny * x + R.arm_tb * w[b] - R.arm_ta * w[a])
    for i in range(n):
        (body[i].ax, body[i].ay), body[i].angular = (after[i] - before[i]) / h, (turned[i] - spin[i]) / h
    scene = scene_with(
        BODY=body, PUSHED=pushed, PUSHED_BY=by, LINK=link, MEMBER=member, STATE=rows(Next, n + 1),
        RESTING=rows(Rest, n), PULL=np.zeros((n + 1, 3)), LOG=rows(Impulse, m),
    )  # fmt: skip
    scene.COUNT.pushes, scene.PAR.dt = m, h

    def energy() -> float:
        v = np.array([(b.vx, b.vy) for b in body[:n]])
        w = np.array([b.spin for b in body[:n]])
        return float(0.5 * (mass @ (v * v).sum(axis=1) + inertia @ (w * w)))

    start = energy()
    repay(scene, 0, t)
    lost = sum(sum(losses(scene, c, t)) for c in range(m))
    for i in range(n):
        move_to(body, i, t)
    assert lost >= -1e-12 * start
    assert energy() + lost == pytest.approx(start, rel=1e-12)
    momentum = mass @ np.array([(b.vx, b.vy) for b in body[:n]])
    assert momentum == pytest.approx(mass @ before, rel=1e-12, abs=1e-12 * size)
