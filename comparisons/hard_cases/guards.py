"""What no program may do: gain energy from an overlap, hang, accept bad input, depend on units or on order."""

from __future__ import annotations

import math

import numpy as np
import pymunk

import eeca_pymunk as ep
import scenes
from comparisons import runs
from scenes.scene import add_disk, add_walls

from .case import DT, G, case, go


@case("overlap at the start", "kinetic energy gained", 0.0)
def overlap(make: runs.Make) -> float:
    gained = 0.0
    for distance in (0.9, 0.5, 0.1, 0.0):
        space = pymunk.Space()
        add_disk(space, (0.0, 0.0), 0.5)
        add_disk(space, (distance, 0.0), 0.5)
        go(space, make, 60)
        gained = max(gained, ep.measure(space).kinetic)
    return gained


@case("resting ball, elastic", "moved (m)", 1e-9)
def resting(make: runs.Make) -> float:
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    ball = add_disk(space, (0.0, 0.5), 0.5)
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    stepper, worst = make(space), 0.0
    for _ in range(600):
        stepper.step(DT)
        worst = max(worst, abs(ball.position.y - 0.5))
    return worst


@case("inelastic collapse, e = .1", "energy rise, or not finite", 1e-12)
def collapse(make: runs.Make) -> float:
    space = pymunk.Space()
    line = [add_disk(space, (1.5 * k, 0.0), 0.5, velocity=(2.0, 0.0)) for k in range(5)]
    add_walls(space, [((7.0, -2.0), (7.0, 2.0))])
    for shape in space.shapes:
        shape.elasticity = math.sqrt(0.1)
    stepper, energy = make(space), [ep.measure(space).energy]
    for _ in range(300):
        stepper.step(DT)
        energy.append(ep.measure(space).energy)
    rise = max(0.0, float(np.diff(energy).max()))
    return rise if all(math.isfinite(b.position.x) for b in line) else math.inf


@case("kinematic plates that squeeze", "not finite, or a plate moved off", 1e-9)
def squeeze(make: runs.Make) -> float:
    space = pymunk.Space()
    plates = []
    for side in (-1.0, 1.0):
        plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        plate.position, plate.velocity = (side * 1.0, 0.0), (-side * 1.0, 0.0)
        face = pymunk.Segment(plate, (0.0, -2.0), (0.0, 2.0), 0.0)
        face.elasticity = 1.0
        space.add(plate, face)
        plates.append(plate)
    disk = add_disk(space, (0.1, 0.0), 0.3, velocity=(1.0, 0.0))
    go(space, make, 45)
    off = max(abs(p.position.x - s * (1.0 - 45 * DT)) for p, s in zip(plates, (-1.0, 1.0), strict=True))
    return off if math.isfinite(disk.position.x) and math.isfinite(disk.velocity.x) else math.inf


@case("units from 1e-3 to 1e4 m", "paths differ (relative)", 1e-9)
def scales(make: runs.Make) -> float:
    ends = []
    for unit in (1.0, 1e-3, 1e4):
        space = pymunk.Space()
        space.gravity = (0.0, -G * unit)
        for k in range(4):
            add_disk(
                space, ((0.3 + 0.7 * k) * unit, (1.0 + 0.1 * k) * unit), 0.2 * unit, velocity=(unit * (1 - k), 0.0)
            )
        corners = [(0.0, 0.0), (3.0 * unit, 0.0), (3.0 * unit, 3.0 * unit), (0.0, 3.0 * unit)]
        add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
        go(space, make, 60)
        ends.append(np.array([b.position for b in space.bodies]) / unit)
    return float(max(np.abs(end - ends[0]).max() for end in ends))


@case("dt from 3e-5 to 1/10", "paths differ (m)", 1e-9)
def steps(make: runs.Make) -> float:
    ends = []
    for dt in (1 / 15, 1 / 60, 1e-5 * 10 / 3):
        scene = scenes.build("gas", seed=3)
        go(scene.space, make, round(0.1 / dt) if dt < 0.05 else 1, dt if dt < 0.05 else 0.1)
        ends.append(np.array([b.position for b in scene.bodies]))
    return float(max(np.abs(end - ends[0]).max() for end in ends))


@case("bad input", "accepted", 0.0)
def guards(make: runs.Make) -> float:
    accepted = 0
    for spoil in ("dt < 0", "dt nan", "velocity nan", "position inf", "mass 0"):
        space = pymunk.Space()
        body = add_disk(space, (0.0, 0.0), 0.5)
        dt = {"dt < 0": -DT, "dt nan": math.nan}.get(spoil, DT)
        try:
            if spoil == "velocity nan":
                body.velocity = (math.nan, 0.0)
            elif spoil == "position inf":
                body.position = (math.inf, 0.0)
            elif spoil == "mass 0":
                bare = pymunk.Body()
                space.add(bare, pymunk.Circle(bare, 0.1))
            make(space).step(dt)
            accepted += 1
        except (ValueError, AssertionError):
            pass
    return accepted


@case("twins: twice, and in another order", "paths differ (m)", 1e-9)
def twins(make: runs.Make) -> float:
    ends = []
    for order in (1, 1, -1):
        space = pymunk.Space()
        rng = np.random.default_rng(5)
        things = [
            (float(x), float(y), *map(float, rng.normal(size=2))) for x in (0.5, 1.5, 2.5) for y in (0.5, 1.5, 2.5)
        ]
        for x, y, u, v in things[::order]:
            add_disk(space, (x, y), 0.3, velocity=(u, v))
        corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)]
        add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
        go(space, make, 60)
        ends.append(np.array([b.position for b in space.bodies])[::order])
    return math.inf if (ends[0] != ends[1]).any() else float(np.abs(ends[2] - ends[0]).max())
