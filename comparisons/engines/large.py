"""Scenes of hundreds of bodies beside Box2D v3: pile, tumbler, pyramid, ragdolls, a grid of joints.

Errors are laws that all engines should keep: shapes do not overlap, pivots hold, energy does not rise where nothing
drives it, and a pyramid stays where it is.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pymunk

import eeca_pymunk as ep
import scenes
from comparisons import program_joints
from comparisons.engines import described
from comparisons.hard_cases.joints import apart
from comparisons.output import Row
from scenes import layouts

LOOKS = 30  # at the states of a run
Asked = Callable[[dict[str, Any]], Any]


@dataclass(frozen=True)
class Large:
    """A scene: how to build it, its dt (s) and steps; whether something drives it, and whether it should stand."""

    name: str
    build: Callable[[], pymunk.Space]
    dt: float = 1 / 60
    steps: int = 300
    driven: bool = False
    stands: bool = False


def listed(part: float = 1.0) -> list[Large]:
    """The scenes, with so many of their bodies."""
    return [
        Large("pile of boxes", lambda: layouts.build("random", "boxes", round(300 * part))),
        Large("pile of disks", lambda: layouts.build("avalanche", "disks", round(300 * part))),
        Large("tumbler", lambda: tumbler(round(300 * part)), driven=True),
        Large("pyramid", lambda: scenes.build("pyramid", rows=max(round(20 * part), 2)).space, stands=True),
        Large("ragdolls", lambda: program_joints.rag_dolls(max(round(20 * part), 1)).space, dt=1 / 120),
        Large("grid of joints", lambda: grid(max(round(30 * part), 2)), steps=120),
    ]


def tumbler(count: int, side: float = 20.0) -> pymunk.Space:
    """`count` boxes of .5 m and 1 kg in a square box of `side` m that turns at .5 rad/s."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    drum = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    drum.angular_velocity = 0.5
    corners = [(x * side / 2, y * side / 2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))]
    space.add(drum, *(pymunk.Segment(drum, a, b, 0.25) for a, b in pairwise(corners)))
    row = math.isqrt(count) + 1
    for k in range(count):
        body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (0.5, 0.5)))
        body.position = 0.7 * (k % row - row / 2), 0.7 * (k // row - row / 2)
        space.add(body, pymunk.Poly.create_box(body, (0.5, 0.5)))
    for shape in space.shapes:
        shape.friction, shape.elasticity = math.sqrt(0.6), 0.0
    return space


def grid(side: int) -> pymunk.Space:
    """side x side disks of 1 kg on pivots between neighbours, 1 m apart; the middle of the upper row is fixed."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    knots: dict[tuple[int, int], pymunk.Body] = {}
    for i in range(side):
        for j in range(side):
            fixed = j == 0 and abs(i - side // 2) <= 1
            body = pymunk.Body(1.0, 0.08, pymunk.Body.STATIC if fixed else pymunk.Body.DYNAMIC)
            body.position = float(i), -float(j)
            disk = pymunk.Circle(body, 0.4)
            disk.filter = pymunk.ShapeFilter(group=1)
            space.add(body, disk)
            knots[i, j] = body
    for (i, j), knot in knots.items():
        for other in ((i - 1, j), (i, j - 1)):
            if other in knots and not knot.body_type == knots[other].body_type == pymunk.Body.STATIC:
                x, y = 0.5 * (knot.position - knots[other].position)
                space.add(pymunk.PivotJoint(knots[other], knot, (x, y), (-x, -y)))
    return space


def moving(space: pymunk.Space) -> list[pymunk.Body]:
    """Its dynamic bodies."""
    return [b for b in space.bodies if b.body_type == pymunk.Body.DYNAMIC]


def played(scene: Large, name: str) -> tuple[np.ndarray[Any, Any], float, float]:
    """States (looks, N, 6) of a run of this package or pymunk, seconds of the process, share of steps unconverged."""
    space = scene.build()
    bodies, unmet, seconds, states = moving(space), 0, 0.0, []
    step: Callable[[float], ep.StepReport | None] = ep.EECA(space, sync=False).step if name == "EECA" else space.step
    for k in range(scene.steps):
        begun = time.process_time()
        report = step(scene.dt)
        seconds += time.process_time() - begun
        unmet += report is not None and not report.converged
        if (k + 1) % every(scene) == 0:
            states.append([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in bodies])
    return np.array(states), seconds, unmet / scene.steps


def every(scene: Large) -> int:
    """Steps between two looks."""
    return max(1, scene.steps // LOOKS)


def errors(scene: Large, states: np.ndarray[Any, Any]) -> Row:
    """Deepest overlap (m), pivots apart (m), rise of energy over its range, way from the start (m); None where there is
    no such law."""
    space = scene.build()
    bodies = moving(space)
    start = np.array([b.position for b in bodies])
    least = first = ep.measure(space).energy
    deepest, gap, rise = 0.0, 0.0, 0.0
    for look, state in enumerate(states):
        for body, (x, y, angle, vx, vy, spin) in zip(bodies, state.tolist(), strict=True):
            body.position, body.angle, body.velocity, body.angular_velocity = (x, y), angle, (vx, vy), spin
        for body in space.bodies:
            if body.body_type == pymunk.Body.KINEMATIC:
                body.angle = body.angular_velocity * scene.dt * every(scene) * (look + 1)
            space.reindex_shapes_for_body(body)
        deepest, gap = max(deepest, overlap(bodies, space)), max(gap, apart(space))
        now = ep.measure(space).energy
        rise, least = max(rise, now - least), min(least, now)
    scale = max(first - least, 1e-3 * abs(first))
    way = float(np.linalg.norm(states[-1][:, :2] - start, axis=1).max())
    return {
        "overlap (m)": deepest, "pivots apart (m)": gap if space.constraints else None,
        "energy rises": None if scene.driven else rise / scale, "moved (m)": way if scene.stands else None,
    }  # fmt: skip


def overlap(bodies: list[pymunk.Body], space: pymunk.Space) -> float:
    """The deepest overlap of pairs that may touch, by pymunk's narrow phase."""
    found = 0.0
    for body in bodies:
        for shape in body.shapes:
            for info in space.shape_query(shape):
                other = info.shape
                if other is None or other.body is body or shape.filter.group == other.filter.group != 0:
                    continue
                found = min(found, min((p.distance for p in info.contact_point_set.points), default=0.0))
    return -found


def rows(asked: Asked, scene: Large) -> list[Row]:
    """pymunk, EECA and Box2D v3 (`asked` runs a job, or says why not) on a scene."""
    found: list[Row] = []
    native = 1.0
    for name in ("pymunk", "EECA", "Box2D v3"):
        unmet: float | None = None
        if name == "Box2D v3":
            space = scene.build()
            job = described.space(space, moving(space))
            job |= {"count": len(moving(space)), "dt": scene.dt, "steps": scene.steps, "every": every(scene)}
            answer = asked({**job, "enough": 0.0})
            if isinstance(answer, str):
                continue
            states, seconds = np.array(answer["states"], dtype=float), float(answer["seconds"])
        else:
            states, seconds, share = played(scene, name)
            unmet = share if name == "EECA" else None
        native = seconds if name == "pymunk" else native
        found.append({
            "scene": scene.name, "engine": name, "us/step": 1e6 * seconds / scene.steps, "x pymunk": seconds / native,
            **errors(scene, states), "not converged": unmet,
        })  # fmt: skip
    return found
