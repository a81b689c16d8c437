"""What each feature of a space adds to a small step: four disks, one flying, step by step beside `Space.step`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np
import pymunk
from tqdm import tqdm

import eeca_pymunk as ep

from .output import Output, Row

DT = 0.01  # s
BLOCKS, STEPS = 12, 40
Each = Callable[[int], object]


def _nothing(*_: object) -> None:
    pass


class Scene:
    """Three disks that rest on a floor and one that flies; `each(k)` is called before step k."""

    def __init__(self) -> None:
        self.space = space = pymunk.Space()
        space.gravity = (0.0, -9.81)
        self.floor = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0.1)
        self.floor.friction = 1.0
        space.add(self.floor)
        self.bodies: list[pymunk.Body] = []
        self.shapes: list[pymunk.Circle] = []
        for i in range(4):
            body = pymunk.Body(1.0, 0.5)
            body.position = (3.0 * i, 0.6 if i < 3 else 200.0)
            shape = pymunk.Circle(body, 0.5)
            shape.friction, shape.collision_type = 0.5, 1 + i
            space.add(body, shape)
            self.bodies.append(body)
            self.shapes.append(shape)
        self.each: Each = _nothing

    @property
    def flying(self) -> pymunk.Body:
        return self.bodies[3]

    def hang(self, joint: pymunk.Constraint) -> None:
        self.space.add(joint)

    def ball(self, kind: int) -> pymunk.Body:
        """A large disk aside, of a body of this kind."""
        body = pymunk.Body(1.0, 1.0, kind)
        body.position = (-20.0, 5.0)
        self.space.add(body, pymunk.Circle(body, 1.0))
        return body


def _fall(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    pymunk.Body.update_velocity(body, gravity, damping, dt)


def _move(body: pymunk.Body, dt: float) -> None:
    pymunk.Body.update_position(body, dt)


def _pin(s: Scene) -> pymunk.PinJoint:
    return pymunk.PinJoint(s.space.static_body, s.flying, (9, 205), (0, 0))


def _three_pins(s: Scene) -> None:
    for b in s.bodies[:3]:
        s.hang(pymunk.PinJoint(s.space.static_body, b, (b.position.x + 0.5, 3.0), (0, 0)))


def _bounded(s: Scene) -> None:
    joint = pymunk.PivotJoint(s.space.static_body, s.flying, (9, 200))
    joint.max_force = 5.0
    s.hang(joint)


def _spring(s: Scene, law: bool = False) -> None:
    spring = pymunk.DampedSpring(s.space.static_body, s.flying, (9, 205), (0, 0), 4, 10, 0.1)
    if law:
        spring.force_func = lambda spring, distance: (4.0 - distance) * 10.0
    s.hang(spring)


def _called_joint(s: Scene) -> None:
    joint = _pin(s)
    joint.post_solve = _nothing
    s.hang(joint)


def _held_outside(s: Scene) -> None:
    hand = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    hand.position = (9, 205)
    s.hang(pymunk.PinJoint(hand, s.flying))
    s.each = lambda k: setattr(hand, "angle", 0.0)


def _come_and_go(s: Scene) -> None:
    mine: list[tuple[pymunk.Body, pymunk.Shape]] = []

    def each(k: int) -> None:
        if k % 10:
            return
        body = pymunk.Body(1.0, 0.5)
        body.position = (30.0 + (k // 10) % 7, 50.0)
        shape = pymunk.Circle(body, 0.2)
        s.space.add(body, shape)
        mine.append((body, shape))
        if len(mine) > 3:
            s.space.remove(*mine.pop(0))

    s.each = each


def _come_and_go_among(s: Scene, others: int) -> None:
    for i in range(others):
        body = pymunk.Body(1.0, 0.5)
        body.position = (-49.0 + 0.1 * i, 0.145)
        s.space.add(body, pymunk.Circle(body, 0.045))
    _come_and_go(s)


def _moved(s: Scene, kind: int) -> None:
    body = s.ball(kind)
    s.each = lambda k: setattr(body, "position", (-20.0, 5.0 + 0.01 * (k % 2)))


def _ask(s: Scene) -> None:
    def each(k: int) -> None:
        for body in s.bodies:
            body.each_arbiter(_nothing)

    s.each = each


def _each(thing: Callable[[Scene], object], name: str, value: Callable[[int], object]) -> Callable[[Scene], None]:
    """A number that is set before each step."""

    def make(s: Scene) -> None:
        of = thing(s)
        s.each = lambda k: setattr(of, name, value(k))

    return make


def _functions(name: str, function: object, first: int) -> Callable[[Scene], None]:
    def make(s: Scene) -> None:
        for body in s.bodies[first:]:
            setattr(body, name, function)

    return make


def _handlers(*phases: str) -> Callable[[Scene], None]:
    return lambda s: s.space.on_collision(None, None, **dict.fromkeys(phases, _nothing))


FEATURES: dict[str, Callable[[Scene], object]] = {
    "plain": _nothing,
    "damping .9": lambda s: setattr(s.space, "damping", 0.9),
    "damping 0": lambda s: setattr(s.space, "damping", 0.0),
    "force in each step": _each(lambda s: s.flying, "force", lambda k: (0.0, 9.0)),
    "centre of mass elsewhere": lambda s: setattr(s.flying, "center_of_gravity", (0.1, 0.0)),
    "gravity set in each step": _each(lambda s: s.space, "gravity", lambda k: (0.0, -9.81 - 0.01 * (k % 2))),
    "kinematic body put": lambda s: _moved(s, pymunk.Body.KINEMATIC),
    "each_arbiter asked": _ask,
    "handler nobody meets": lambda s: s.space.on_collision(4, 3, post_solve=_nothing),
    "pre_solve, 3 contacts": _handlers("pre_solve"),
    "post_solve, 3 contacts": _handlers("post_solve"),
    "all four handlers": _handlers("begin", "pre_solve", "post_solve", "separate"),
    "velocity function": _functions("velocity_func", _fall, 3),
    "velocity functions of all": _functions("velocity_func", _fall, 0),
    "position function": _functions("position_func", _move, 3),
    "pin": lambda s: s.hang(_pin(s)),
    "three pins": _three_pins,
    "pivot with max_force": _bounded,
    "spring": _spring,
    "spring with a law": lambda s: _spring(s, True),
    "joint with post_solve": _called_joint,
    "joint to a body outside": _held_outside,
    "sleep threshold": lambda s: setattr(s.space, "sleep_time_threshold", 0.5),
    "friction set": _each(lambda s: s.shapes[0], "friction", lambda k: 0.5 + 0.1 * (k % 2)),
    "elasticity set": _each(lambda s: s.floor, "elasticity", lambda k: 0.1 * (k % 2)),
    "surface velocity set": _each(lambda s: s.floor, "surface_velocity", lambda k: (0.1 * (k % 2), 0.0)),
    "filter set": _each(lambda s: s.shapes[3], "filter", lambda k: pymunk.ShapeFilter(group=1 + k % 2)),
    "mass set": _each(lambda s: s.flying, "mass", lambda k: 1.0 + 0.1 * (k % 2)),
    "body added and removed every 10 steps": _come_and_go,
    "the same among 300 bodies at rest": lambda s: _come_and_go_among(s, 300),
    "static body put": lambda s: _moved(s, pymunk.Body.STATIC),
}
CHOICES = FEATURES


def run(output: Output, full: bool, only: Sequence[str] = ()) -> None:
    """Time all features, or only some; --full takes ten times as many steps."""
    blocks = BLOCKS * (10 if full else 1)
    output.parameters({"dt (s)": DT, "blocks": blocks, "steps of a block": STEPS})
    bar = tqdm(list(only or FEATURES), desc="features", unit="feature", disable=None)
    output.table("A step with one feature", [feature(name, blocks) for name in bar])


def feature(name: str, blocks: int) -> Row:
    """One row: the least over blocks, which come in turn, of the mean step's processor time."""
    makes: dict[str, Callable[[pymunk.Space], object]] = {
        "native": lambda space: space, "EECA": ep.EECA, "sync=False": lambda space: ep.EECA(space, sync=False),
    }  # fmt: skip
    runs: list[tuple[Scene, Callable[[float], object]]] = []
    for make in makes.values():
        scene = Scene()
        FEATURES[name](scene)
        stepping: pymunk.Space | ep.Stepper = make(scene.space)  # type: ignore[assignment]
        runs.append((scene, stepping.step))
    times: list[list[float]] = [[] for _ in runs]
    for block in range(blocks):
        for (scene, step), found in zip(runs, times, strict=True):
            took = 0.0
            for k in range(STEPS):
                scene.each(STEPS * block + k)
                begun = time.thread_time()
                step(DT)
                took += time.thread_time() - begun
            found.append(1e6 * took / STEPS)
    native, ours, unsynced = (float(np.min(found[1:])) for found in times)
    return {
        "feature": name, "native us": native, "EECA us": ours, "to native": ours / native,
        "sync=False us": unsynced, "sync=False to native": unsynced / native,
    }  # fmt: skip
