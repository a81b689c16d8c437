"""End states of many scenes, bit by bit: `python -m tests.bitwise` prints a hash for each.

Two kinds of machine code of the same kernels, or the kernels before and after a change that alters nothing, print the
same lines: EECA_KERNELS=jit python -m tests.bitwise | diff - <(EECA_KERNELS=library python -m tests.bitwise).
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable

import numpy as np
import pymunk
from tqdm import tqdm

import eeca_pymunk as ep
import scenes

Make = Callable[[], tuple[pymunk.Space, float]]  # a space and its dt


def _scene(name: str, dt: float = 1 / 60, **parameters: object) -> Make:
    return lambda: (scenes.build(name, **parameters).space, dt)


def _lossy(name: str, elasticity: float, friction: float = 0.0, dt: float = 1 / 60, **parameters: object) -> Make:
    def make() -> tuple[pymunk.Space, float]:
        space = scenes.build(name, **parameters).space
        for shape in space.shapes:
            shape.elasticity, shape.friction = elasticity, friction
        return space, dt

    return make


def _box(gravity: float = -9.81) -> pymunk.Space:
    space = pymunk.Space()
    space.gravity = (0.0, gravity)
    corners = [(-3, 0), (3, 0), (3, 12), (-3, 12)]
    for i, corner in enumerate(corners):
        wall = pymunk.Segment(space.static_body, corner, corners[(i + 1) % 4], 0.05)
        wall.elasticity, wall.friction = 0.5, 0.5
        space.add(wall)
    return space


def _heap(count: int, jointed: bool = False) -> pymunk.Space:
    """Boxes and disks that fall into a box; `jointed`: in pairs."""
    space, random = _box(), np.random.default_rng(5)
    before: pymunk.Body | None = None
    for i in range(count):
        body = pymunk.Body(1.0, 0.1)
        body.position = (float(random.uniform(-2, 2)), 0.5 + 0.45 * i)
        shape: pymunk.Shape = pymunk.Poly.create_box(body, (0.4, 0.3)) if i % 2 else pymunk.Circle(body, 0.2)
        shape.elasticity, shape.friction = 0.2, 0.5
        space.add(body, shape)
        if jointed and before is not None and i % 2:
            space.add(pymunk.PivotJoint(before, body, tuple((before.position + body.position) / 2)))
        before = body
    return space


def _handlers() -> tuple[pymunk.Space, float]:
    space = _heap(12)

    def slippery(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        arbiter.friction = 0.1

    space.on_collision(pre_solve=slippery)
    return space, 1 / 60


def _sleeping() -> tuple[pymunk.Space, float]:
    space = scenes.build("pyramid").space
    space.sleep_time_threshold = 0.2
    return space, 1 / 60


def _motor() -> tuple[pymunk.Space, float]:
    space = _box()
    wheel, arm = pymunk.Body(1, 0.1), pymunk.Body(0.5, 0.05)
    wheel.position, arm.position = (0, 1.0), (0.6, 1.0)
    space.add(wheel, arm, pymunk.Circle(wheel, 0.3), pymunk.Poly.create_box(arm, (0.5, 0.1)))
    space.add(pymunk.PivotJoint(wheel, arm, (0.35, 1.0)), pymunk.SimpleMotor(wheel, arm, 3.0))
    space.add(pymunk.DampedSpring(space.static_body, wheel, (0, 3), (0, 0), 1.5, 20.0, 0.3))
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.4, 0.6
    return space, 1 / 120


def _kinematic() -> tuple[pymunk.Space, float]:
    space = _heap(10)
    paddle = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    paddle.position, paddle.angular_velocity = (0, 1.5), 2.0
    bar = pymunk.Segment(paddle, (-0.8, 0), (0.8, 0), 0.05)
    bar.elasticity, bar.friction = 0.5, 0.5
    space.add(paddle, bar)
    return space, 1 / 100


def _fluid() -> tuple[pymunk.Space, float]:
    space, random = _box(0.0), np.random.default_rng(2)
    space.damping = 0.9
    for i in range(40):
        body = pymunk.Body(1.0, 0.005)
        body.position, body.velocity = (-2.5 + 0.6 * (i % 8), 0.5 + 0.7 * (i // 8)), tuple(random.normal(size=2))
        disk = pymunk.Circle(body, 0.1)
        disk.elasticity = 1.0
        space.add(body, disk)
    return space, 1 / 50


CASES: dict[str, tuple[Make, int]] = {
    "gas": (_scene("gas", count=100, dt=1e-2), 60),
    "gas of a thousand": (_scene("gas", count=1000, dt=1e-3), 40),
    "lossy gas": (_lossy("gas", 0.6, 0.3, 1e-2, count=100), 80),
    "mixed shapes": (_scene("mixed", bowl=True), 60),
    "mixed shapes that rub": (_lossy("mixed", 0.5, 0.5, bowl=True), 60),
    "pool break": (_scene("pool_break", dt=1e-2), 60),
    "billiard": (_scene("billiard", dt=1e-2), 60),
    "carom": (_scene("carom", dt=1e-2), 60),
    "cradle": (_scene("cradle"), 60),
    "pile": (_scene("pile"), 120),
    "pyramid": (_scene("pyramid"), 60),
    "slope": (_scene("slope"), 60),
    "drum": (_scene("drum"), 60),
    "hopper": (_scene("hopper", dt=2e-3), 100),
    "pendulum": (_scene("pendulum"), 120),
    "double pendulum": (_scene("double_pendulum"), 60),
    "chain": (_scene("chain"), 60),
    "bridge": (_scene("bridge"), 60),
    "rods": (_scene("rods"), 60),
    "heap": (lambda: (_heap(24), 1 / 60), 150),
    "jointed heap": (lambda: (_heap(16, True), 1 / 60), 120),
    "handlers": (_handlers, 80),
    "sleeping": (_sleeping, 90),
    "motor and spring": (_motor, 150),
    "kinematic": (_kinematic, 100),
    "damped": (_fluid, 100),
}
CLOSURES = {"TimeOfImpact": ep.TimeOfImpact, "Midstep": ep.Midstep}


def states(space: pymunk.Space) -> np.ndarray:
    """(N, 6) poses and velocities of all bodies."""
    return np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies])


def digest(name: str, closure: str) -> str:
    """The hash of all states of a case, after each tenth step and at the end."""
    make, steps = CASES[name]
    space, dt = make()
    stepper = ep.EECA(space, CLOSURES[closure]())
    found = hashlib.sha256()
    for step in range(steps):
        stepper.step(dt)
        if step % 10 == 0 or step == steps - 1:
            found.update(states(space).tobytes())
    return found.hexdigest()[:16]


def main() -> None:
    """Print a line for each case and closure."""
    for name in tqdm(CASES, desc="scenes", file=sys.stderr, disable=None):
        for closure in CLOSURES:
            try:
                found = digest(name, closure)
            except ep.UnsupportedFeature as error:
                found = type(error).__name__
            print(f"{name}, {closure}: {found}", flush=True)


if __name__ == "__main__":
    main()
