"""A lander and a walker under EECA and pymunk: what a step costs, whether joints hold, whether a reset repeats."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pymunk

import eeca_pymunk as ep
import scenes
from comparisons.output import Output, Row
from comparisons.runs import Make
from scenes import Scene

NAMES = ("lander", "walker")
STEPPERS: dict[str, Make] = {"EECA": ep.EECA, "pymunk": ep.Native}
SECONDS = 8.0
STEPS = (1 / 50, 1 / 200, 1 / 800)  # s
ITERATIONS = (10, 200)  # of pymunk's solver
REPEATS = 3


@dataclass(frozen=True)
class Episode:
    """Measures of one run from the start of a scene.

    path: (T, N, 3) places (m) and angles of its bodies.  gap: the largest distance of the two points of a pivot (m).
    surplus: the most energy above that of the start and what the driver can have put in (J).  seconds: of one step.
    """

    path: npt.NDArray[np.float64]
    gap: float
    surplus: float
    seconds: float


def gaps(space: pymunk.Space) -> float:
    """The largest distance of the two points that a pivot holds together (m)."""
    pivots = [c for c in space.constraints if isinstance(c, pymunk.PivotJoint)]
    return max((p.a.local_to_world(p.anchor_a) - p.b.local_to_world(p.anchor_b)).length for p in pivots)


def episode(scene: Scene, stepper: ep.Stepper, count: int) -> Episode:
    """Run `count` steps from where the scene is."""
    assert scene.driver is not None
    start = ep.measure(scene.space).energy
    path, gap, surplus, taken = [], 0.0, -np.inf, 0.0
    for _ in range(count):
        begun = time.perf_counter()
        stepper.step(scene.dt)
        taken += time.perf_counter() - begun
        gap = max(gap, gaps(scene.space))
        surplus = max(surplus, ep.measure(scene.space).energy - start - scene.driver.work())
        path.append([(*body.position, body.angle) for body in scene.bodies])
    return Episode(np.array(path), gap, surplus, taken / max(count, 1))


def again(scene: Scene, stepper: ep.Stepper) -> None:
    """What an environment does between two episodes: all bodies back to the start, in the same space."""
    scene.reset()
    stepper.refresh()


def compare(name: str, seconds: float) -> list[Row]:
    """One row for each stepper: an episode, a reset, the same again."""
    rows: list[Row] = []
    for title, make in STEPPERS.items():
        scene = scenes.build(name)
        stepper, count = make(scene.space), round(seconds / scene.dt)
        runs = [episode(scene, stepper, count)]
        for _ in range(REPEATS - 1):
            again(scene, stepper)
            runs.append(episode(scene, stepper, count))
        first = runs[0]
        rows.append({
            "scene": name, "stepper": title, "ms/step": 1e3 * min(run.seconds for run in runs),
            "pivots apart (m)": first.gap, "surplus (J)": max(0.0, first.surplus),
            "differs after reset (m)": max(float(np.abs(run.path - first.path)[..., :2].max()) for run in runs),
        })  # fmt: skip
    return rows


def distance(make: Make, iterations: int, dt: float, seconds: float) -> float:
    """How far the walker gets (m)."""
    scene = scenes.build("walker", dt=dt)
    scene.space.iterations = iterations
    stepper = make(scene.space)
    for _ in range(round(seconds / dt)):
        stepper.step(dt)
    return float(scene.bodies[0].position.x)


def run(output: Output, full: bool) -> None:
    """Print both tables; how far the walker gets, by dt."""
    output.table("Episodes of 8 s, dt = 1/50 s", [row for name in NAMES for row in compare(name, SECONDS)])
    rows: list[Row] = []
    for title, make, iterations in (("EECA", ep.EECA, 10), *(("pymunk", ep.Native, i) for i in ITERATIONS)):
        ways = {f"dt = 1/{round(1 / dt)} s": distance(make, iterations, dt, 0.5 * SECONDS) for dt in STEPS}
        rows.append({"stepper": title, "iterations": iterations if title == "pymunk" else None, **ways})
    output.table("How far the walker gets in 4 s (m)", rows, "distance")
