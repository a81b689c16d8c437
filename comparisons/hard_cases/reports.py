"""What users of engines report, with the place where they do."""

from __future__ import annotations

import math

import numpy as np
import pymunk

import eeca_pymunk as ep
from comparisons import runs
from scenes import pendulum
from scenes.scene import add_box, add_disk, add_walls

from .case import DT, LONG, G, case, go, heavy, matter
from .friction import after, on_plane
from .piles import FLOOR, moved


@case("creep on a 1° slope (matter-js 612)", "moved in 60 s (m)", 1e-9)
def creep(make: runs.Make) -> float:
    body = after(on_plane(math.radians(1.0), 0.5, "box"), make, 60.0)
    return math.hypot(body.position.x, body.position.y - 0.5)


@case("grip at 20 times its margin (MuJoCo 3328)", "slipped in 20 s (m)", 1e-9)
def grip(make: runs.Make) -> float:
    """A box between two heavy ones that press it sideways; the grip's force is gravity's along x."""
    space = pymunk.Space()
    space.gravity = (20.0 * G, -G)
    add_walls(space, [((1.0, -9.0), (1.0, 9.0))])
    add_box(space, (0.5, 0.0), 1.0, 1.0)
    matter(space, 1.0)
    return moved(space, make, 1200)


@case("mass ratio 100, upper sinks (DART 3442)", "moved in 10 s (m)", 1e-9)
def ratio(make: runs.Make) -> float:
    space = heavy()
    add_walls(space, FLOOR)
    add_box(space, (0.0, 0.5), 1.0, 1.0, 1.0)
    add_box(space, (0.0, 1.5), 1.0, 1.0, 100.0)
    matter(space, 0.5)
    return moved(space, make, 600)


@case("tower with a heavy top (Jolt 1392)", "moved in 10 s (m)", 1e-6)
def tower(make: runs.Make) -> float:
    space = heavy()
    add_walls(space, FLOOR)
    for k in range(8):
        add_box(space, (0.0, 0.5 + k), 1.0, 1.0)
    add_box(space, (0.0, 9.0), 2.0, 2.0, 50.0)
    matter(space, 0.5)
    return moved(space, make, 600)


@case("five boxes collapse (qu3e 54)", "moved in 10 s (m)", 1e-9)
def five(make: runs.Make) -> float:
    space = heavy()
    add_walls(space, FLOOR)
    for k in range(5):
        add_box(space, (0.02 * (k % 2), 0.5 + k), 1.0, 1.0)
    matter(space, 0.3)
    return moved(space, make, 600)


@case("asleep at the apex (box2d 906)", "place off / amplitude, after 20 s", 1e-6)
def asleep(make: runs.Make) -> float:
    """A pendulum of 5°, which turns back slowly, where what is slow for .1 s may fall asleep."""
    scene, dt = pendulum.build(degrees=5.0), 1 / 120
    scene.space.sleep_time_threshold = 0.1
    go(scene.space, make, round(20.0 / dt), dt)
    exact = scene.exact(20.0)
    assert exact is not None
    off = float(np.linalg.norm(np.array(scene.bodies[0].position) - exact))
    scene.bodies[0].activate()  # pymunk frees a jointed body that is asleep after its space, and crashes then
    return off / math.radians(5.0)


@case("ball of e = 1 climbs (rapier 97, Jolt 1286)", "energy off (relative)", 1e-9)
def climbs(make: runs.Make) -> float:
    """For 60 s, rough, with spin: friction is spent after the first impacts, and the rest must stay."""
    space = heavy()
    add_walls(space, FLOOR)
    ball = add_disk(space, (0.0, 2.5), 0.5)
    ball.angular_velocity = 3.0
    matter(space, 0.5, 1.0)
    stepper = make(space)
    go_on = [ep.measure(space).energy]
    for _ in range(LONG["resting"]):
        stepper.step(DT)
        go_on.append(ep.measure(space).energy)
    settled = go_on[120]
    return float(np.abs(np.array(go_on[120:]) / settled - 1.0).max())


@case("last bounces swallowed (PhysX 351)", "apex off (relative)", 1e-9)
def swallowed(make: runs.Make) -> float:
    """The fifth bounce of e = .5, a millimetre high, at dt = 1/240."""
    space, e, height, dt = heavy(), 0.5, 1.0, 1 / 240
    add_walls(space, FLOOR)
    ball = add_disk(space, (0.0, 0.5 + height), 0.5)
    matter(space, 0.0, e)
    fall = math.sqrt(2.0 * height / G)
    at = fall * (1.0 + 2.0 * (e + e**2 + e**3 + e**4) + e**5)
    go(space, make, round(at / dt), dt)
    apex = ball.position.y - 0.5 + 0.5 * ball.velocity.y**2 / G
    return abs(apex / (height * e**10) - 1.0)


@case("slow balls stick to walls (planck 217)", "speed off (relative)", 1e-12)
def sticky(make: runs.Make) -> float:
    """At a slant and rough, down to 1e-4 m/s: the closed law at every speed."""
    worst = 0.0
    for v in (1.0, 1e-2, 1e-4):
        space = pymunk.Space()
        add_walls(space, FLOOR)
        ball = add_disk(space, (0.0, 0.5 + 5.5 * v * DT), 0.5, 1.0, (0.5 * v, -v))
        matter(space, 0.2, 0.8)
        go(space, make, 10)
        p = min(0.5 / 3.0, 0.2 * 1.8)
        found = np.array((ball.velocity.x, ball.velocity.y)) / v
        worst = max(worst, float(np.abs(found - (0.5 - p, 0.8)).max()))
    return worst
