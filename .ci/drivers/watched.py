"""What a client's spaces do, in the client's own environment: their `step` is timed, as it is or replaced by ours.

A driver calls `watch(sys.argv)` before its client makes a space, plays, and calls `tell` with numbers of the end.
"""

from __future__ import annotations

import atexit
import json
import math
import sys
import time

import pymunk

CASE: dict[str, object] = {}
_steps: list[float] = []
_uses: set[str] = set()
_deepest = [0.0]
_apart = [0.0]
_EVERY = 7  # steps between two looks at overlaps


def watch(arguments: list[str]) -> None:
    """Replace `Space.step`: arguments are `native` or `eeca`, and the file that the answer goes to."""
    solver, CASE["answer"] = arguments[1], arguments[2]
    native = pymunk.Space.step
    steppers: dict[int, object] = {}
    if solver == "eeca":
        import eeca_pymunk as ep

        ep.warmup()

    def step(self: pymunk.Space, dt: float) -> None:
        if solver == "eeca" and id(self) not in steppers:
            steppers[id(self)] = ep.EECA(self)
        begun = time.perf_counter()
        if solver == "eeca":
            steppers[id(self)].step(dt)
        else:
            native(self, dt)
        _steps.append(time.perf_counter() - begun)
        if len(_steps) % _EVERY == 1:
            look(self)

    pymunk.Space.step = step
    atexit.register(lambda: CASE.get("told") or _write({"says": "ended before it told anything"}))


def look(space: pymunk.Space) -> None:
    """Note what the space has, how deep shapes overlap, and how far pivots are apart."""
    _uses.update(type(shape).__name__ for shape in space.shapes)
    _uses.update(type(joint).__name__ for joint in space.constraints)
    for handler in space._handlers.values():
        _uses.update(p[1:] for p in ("_begin", "_pre_solve", "_post_solve", "_separate") if getattr(handler, p))
    _uses.update(["damping"] if space.damping != 1.0 else [])
    _uses.update(["sleeping"] if space.sleep_time_threshold != math.inf else [])
    for body in space.bodies:
        _uses.update(["kinematic bodies"] if body.body_type == pymunk.Body.KINEMATIC else [])
        _uses.update(["velocity_func"] if body._velocity_func else [])
        _uses.update(["position_func"] if body._position_func else [])
    _uses.update(["sensors"] if any(s.sensor for s in space.shapes) else [])
    _uses.update(["friction"] if any(s.friction for s in space.shapes) else [])
    for shape in space.shapes:
        if shape.body.body_type == pymunk.Body.DYNAMIC and not shape.sensor:
            for other in space.shape_query(shape):
                met = other.shape
                if met is None or met.sensor or met.body is shape.body or shape.filter.group == met.filter.group != 0:
                    continue
                if not (shape.filter.mask & met.filter.categories and met.filter.mask & shape.filter.categories):
                    continue
                _deepest[0] = max([_deepest[0], *(-p.distance for p in other.contact_point_set.points)])
    for joint in space.constraints:
        if isinstance(joint, pymunk.PivotJoint):
            away = joint.a.local_to_world(joint.anchor_a) - joint.b.local_to_world(joint.anchor_b)
            _apart[0] = max(_apart[0], away.length)


def tell(values: dict[str, float]) -> None:
    """The end: numbers by name."""
    CASE["told"] = True
    later = _steps[5:]
    _write({
        "says": "runs", "pymunk": pymunk.version, "steps": len(_steps), "us": 1e6 * sum(later) / max(1, len(later)),
        "uses": sorted(_uses), "overlap": _deepest[0], "apart": _apart[0],
        "values": {name: float(value) for name, value in values.items()},
    })  # fmt: skip
    sys.stdout.flush()


def _write(answer: dict[str, object]) -> None:
    with open(str(CASE["answer"]), "w") as file:
        json.dump(answer, file)
