"""Many elastic bodies: energy, and nobody lost."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pymunk

import eeca_pymunk as ep
import scenes
from comparisons import runs
from comparisons.hopper import crossed
from comparisons.pool_break import asymmetry
from scenes.scene import add_disk, add_walls

from .case import LONG, case, go


@case("break of 55 disks", "energy, momentum, symmetry at 6 ms off", 1e-9)
def pool_break(make: runs.Make) -> float:
    scene = scenes.build("pool_break")
    stepper = go(scene.space, make, 24, scene.dt)
    asymmetric = asymmetry(scene)
    for _ in range(176):
        stepper.step(scene.dt)
    now = ep.measure(scene.space)
    momentum = float(np.abs(now.linear_momentum - (0.0, 1.5)).max())
    return max(abs(now.energy / 7.5 - 1.0), momentum, asymmetric)


@case("nearly parallel contacts, 720-gon", "energy off (relative)", 1e-9)
def parallel_contacts(make: runs.Make) -> float:
    space = pymunk.Space()
    add_disk(space, (0.0, 0.5), 1.0, velocity=(1.0, 0.3))
    angle = np.linspace(0.0, 2.0 * math.pi, 721)
    rim = [(4.0 * math.cos(a), 4.0 * math.sin(a)) for a in angle]
    add_walls(space, pairwise(rim))
    stepper, worst = make(space), 0.0
    for _ in range(LONG["720-gon"]):
        stepper.step(0.01)
        worst = max(worst, abs(ep.measure(space).energy / 0.545 - 1.0))
    return worst


@case("mixed shapes, 10 s", "energy off, or outside", 1e-11)
def mixed(make: runs.Make) -> float:
    scene = scenes.build("mixed")
    go(scene.space, make, 600)
    x = np.array([b.position for b in scene.bodies])
    return (
        math.inf
        if (x < 0.0).any() or (x > 4.0).any()
        else abs(ep.measure(scene.space).energy / ep.measure(scenes.build("mixed").space).energy - 1.0)
    )


@case("crowd of 100 disks, 20 000 steps", "energy off, or outside", 1e-11)
def crowd(make: runs.Make) -> float:
    rng = np.random.default_rng(0)
    space = pymunk.Space()
    for k in range(100):
        vx, vy = rng.normal(scale=3.0, size=2)
        add_disk(space, (1.0 + 2.0 * (k % 10), 1.0 + 2.0 * (k // 10)), 0.4, velocity=(float(vx), float(vy)))
    corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    start = ep.measure(space).energy
    go(space, make, LONG["crowd"])
    x = np.array([b.position for b in space.bodies])
    return math.inf if (x < 0.0).any() or (x > 20.0).any() else abs(ep.measure(space).energy / start - 1.0)


@case("hopper, dt = .0025, .5 s", "energy off, or leaked", 1e-11)
def hopper(make: runs.Make) -> float:
    scene = scenes.build("hopper")
    stepper, start = make(scene.space), ep.measure(scene.space).energy
    leaked, x = 0, np.array([b.position for b in scene.bodies])
    for _ in range(200):
        stepper.step(scene.dt)
        before, x = x, np.array([b.position for b in scene.bodies])
        leaked += int(crossed(before, x).sum())
    return float(leaked) if leaked else abs(ep.measure(scene.space).energy / start - 1.0)
