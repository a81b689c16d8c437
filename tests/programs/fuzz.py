"""Random programs of API calls: a space is built, edited, stepped, asked and listened to, in any order.

`Program` draws what to do next and does it. After every step its rules hold: all is finite, the ledger closes, energy
does not rise but by what the ledger calls external, and what raises leaves all as it was. Draws are either hypothesis's
(`Drawn`), which finds the shortest program that fails, or plainly random (`Thrown`), which finds failures sooner.
"""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable, Iterable
from random import Random
from typing import Any, Protocol

import pymunk
from hypothesis import note
from hypothesis import strategies as st

import eeca_pymunk as ep

from ..steppers import state

DT = 1 / 60
# Elastic bodies that were put deep into one another gain up to 1e-4 of the scale of energy now and then.
GAIN = 1e-3
KINDS = (pymunk.Body.DYNAMIC, pymunk.Body.DYNAMIC, pymunk.Body.DYNAMIC, pymunk.Body.KINEMATIC, pymunk.Body.STATIC)
NUMBERS, SIZES = (-3.0, 3.0), (0.1, 0.6)


class Chance(Protocol):
    """What a program draws from."""

    def between(self, low: float, high: float) -> float:
        """A number of two decimals."""

    def one(self, found: list[Any]) -> Any:
        """One of a list that is not empty."""

    def told(self, text: str) -> None:
        """What the program does next."""


class Drawn:
    """Draws of hypothesis."""

    def __init__(self, data: st.DataObject) -> None:
        self.data = data

    def between(self, low: float, high: float) -> float:
        return float(self.data.draw(st.floats(low, high, allow_nan=False).map(lambda x: round(x, 2))))

    def one(self, found: list[Any]) -> Any:
        return self.data.draw(st.sampled_from(found))

    def told(self, text: str) -> None:
        note(text)


class Thrown:
    """Draws of a seed; `calls` is what the program has done."""

    def __init__(self, seed: int) -> None:
        self.random, self.calls = Random(seed), list[str]()

    def between(self, low: float, high: float) -> float:
        return round(self.random.uniform(low, high), 2)

    def one(self, found: list[Any]) -> Any:
        return self.random.choice(found)

    def told(self, text: str) -> None:
        self.calls.append(text)


class Program:
    """One random program.

    Args:
        gain: what losses may be below 0, in parts of the scale.  joints: whether bodies are joined, too.
    """

    def __init__(self, chance: Chance, gain: float = GAIN, joints: bool = False) -> None:
        self.chance, self.gain, self.joints = chance, gain, joints
        self.space = pymunk.Space()
        self.space.add(pymunk.Segment(self.space.static_body, (-5.0, -3.0), (5.0, -3.0), 0.1))
        self.stepper = ep.EECA(self.space, sync=self.flag())
        self.steps = 0
        self.calls = 0
        self.parted: list[pymunk.Constraint] = []

    def flag(self) -> bool:
        return bool(self.one((False, True)))

    def number(self) -> float:
        return self.chance.between(*NUMBERS)

    def size(self) -> float:
        return self.chance.between(*SIZES)

    def one(self, things: Iterable[Any]) -> Any:
        found = list(things)
        return self.chance.one(found) if found else None

    def body(self) -> pymunk.Body | None:
        return self.one(self.space.bodies)  # type: ignore[no-any-return]

    def shape(self) -> pymunk.Shape | None:
        return self.one(self.space.shapes)  # type: ignore[no-any-return]

    # What a program may do.

    def add(self) -> None:
        if len(self.space.bodies) > 8:
            return
        kind = self.one(KINDS)
        body = pymunk.Body(1.0 + self.size(), self.one((0.1, 1.0, math.inf)), kind)
        body.position, body.angle = (self.number(), self.number()), self.number()
        if kind != pymunk.Body.STATIC:
            self._move(body)
        make: Callable[[], pymunk.Shape] = self.one(
            (
                lambda: pymunk.Circle(body, self.size(), self.one(((0.0, 0.0), (0.1, 0.2)))),
                lambda: pymunk.Poly.create_box(body, (self.size(), self.size()), self.one((0.0, 0.05))),
                lambda: pymunk.Segment(body, (-self.size(), 0.0), (self.size(), 0.1), 0.05),
            )
        )
        shape = make()
        self._dress(shape)
        self.space.add(body, shape)

    def _dress(self, shape: pymunk.Shape) -> None:
        shape.elasticity = self.one((0.0, 0.5, 1.0))
        shape.friction = self.one((0.0, 0.3, 1.5))
        shape.sensor = self.one((False, False, False, True))

    def remove(self) -> None:
        body = self.body()
        if body is not None:
            self.space.remove(body, *(s for s in body.shapes if s.space is not None))

    def remove_shape(self) -> None:
        shape = self.shape()
        if shape is not None:
            self.space.remove(shape)

    def join(self) -> None:
        """Any of the ten joints between two bodies, with a max_force now and then."""
        a, b = self.body(), self.one((*self.space.bodies, self.space.static_body))
        if not isinstance(b, pymunk.Body) or a is None or a is b or len(self.space.constraints) > 5:
            return
        if pymunk.Body.DYNAMIC not in (a.body_type, b.body_type):
            return
        p, q = ((self.size(), 0.0), (0.0, self.size()))
        make: Callable[[], pymunk.Constraint] = self.one(
            (
                lambda: pymunk.PinJoint(a, b, p, q),
                lambda: pymunk.SlideJoint(a, b, p, q, 0.2, 0.2 + self.size()),
                lambda: pymunk.PivotJoint(a, b, p, q),
                lambda: pymunk.GrooveJoint(a, b, (0.0, 0.0), p, q),
                lambda: pymunk.DampedSpring(a, b, p, q, self.size(), 20.0, self.size()),
                lambda: pymunk.DampedRotarySpring(a, b, self.number(), 5.0, self.size()),
                lambda: pymunk.RotaryLimitJoint(a, b, -self.size(), self.size()),
                lambda: pymunk.RatchetJoint(a, b, 0.0, self.size()),
                lambda: pymunk.GearJoint(a, b, self.number(), 1.0 + self.size()),
                lambda: pymunk.SimpleMotor(a, b, self.number()),
            )
        )
        joint = make()
        joint.max_force = self.one((math.inf, 0.5, 20.0))
        joint.collide_bodies = self.flag()
        self.space.add(joint)

    def part(self) -> None:
        joint = self.one(self.space.constraints)
        if joint is not None:
            self.space.remove(joint)
            self.parted.append(joint)  # as long as it lives, its bodies know it

    def teleport(self) -> None:
        body = self.body()
        if body is not None:
            body.position, body.angle = (self.number(), self.number()), self.number()
            self.space.reindex_shapes_for_body(body)

    def drive(self) -> None:
        body = self.body()
        if body is not None and body.body_type != pymunk.Body.STATIC:
            self._move(body)

    def _move(self, body: pymunk.Body) -> None:
        body.velocity = self.number(), self.number()
        body.angular_velocity = self.number()

    def push(self) -> None:
        body = self.body()
        if body is not None and body.body_type == pymunk.Body.DYNAMIC:
            body.apply_force_at_local_point((self.number(), self.number()), (self.number(), 0.0))
            body.apply_impulse_at_world_point((self.number(), 0.0), (0.0, self.number()))

    def edit(self) -> None:
        shape, body = self.shape(), self.body()
        if shape is not None:
            self._dress(shape)
            shape.surface_velocity = (self.one((0.0, 1.0)), 0.0)
            if isinstance(shape, pymunk.Circle):
                shape.unsafe_set_radius(self.size())
            elif isinstance(shape, pymunk.Segment) and shape.body is not self.space.static_body:
                shape.unsafe_set_endpoints((-self.size(), 0.0), (self.size(), 0.0))
        if body is not None and body.body_type == pymunk.Body.DYNAMIC:
            body.mass = 1.0 + self.size()

    def turn_kind(self) -> None:
        body = self.body()
        if body is not None and not body.constraints:  # pymunk asserts that one body of a joint is dynamic
            body.body_type = self.one(KINDS)
            if body.body_type == pymunk.Body.DYNAMIC:
                body.mass, body.moment = 1.5, 1.0

    def set_space(self) -> None:
        self.space.gravity = self.one(((0.0, 0.0), (0.0, -9.81), (3.0, 3.0)))
        self.space.damping = self.one((1.0, 1.0, 0.9, 0.0))

    def listen(self) -> None:
        def count(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
            self.calls += 1

        def remove(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
            self.calls += 1
            for shape in arbiter.shapes:
                if shape.body is not space.static_body and shape.space is not None and self.calls % 3 == 0:
                    space.remove(shape)

        def add(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
            if len(space.bodies) < 9:
                body = pymunk.Body(1.0, 1.0)
                body.position = (0.0, 4.0)
                space.add(body, pymunk.Circle(body, 0.1))

        phase = self.one(("begin", "pre_solve", "post_solve", "separate"))
        self.space.on_collision(**{phase: self.one((count, remove, add, pymunk.empty_callback))})  # type: ignore[misc]

    def functions(self) -> None:
        body = self.body()
        if body is not None and body.body_type != pymunk.Body.STATIC:
            body.velocity_func = self.one((pymunk.Body.update_velocity, _slow))

    def after(self) -> None:
        self.space.add_post_step_callback(lambda space, key: setattr(self, "calls", self.calls + 1), self.steps)

    def ask(self) -> None:
        at = (self.number(), self.number())
        self.space.point_query_nearest(at, 1.0, pymunk.ShapeFilter())
        self.space.segment_query((0.0, 9.0), at, 0.1, pymunk.ShapeFilter())
        for body in self.space.bodies:
            body.each_arbiter(lambda arbiter: arbiter.contact_point_set)

    def save(self) -> None:
        handlers = self.space._handlers
        stiff = any(pymunk.Body.DYNAMIC not in (c.a.body_type, c.b.body_type) for c in self.space.constraints)
        if not handlers and not stiff and not any(b._velocity_func for b in self.space.bodies):
            pickle.loads(pickle.dumps(self.stepper))
            copy.deepcopy(self.space)

    def native(self) -> None:
        # pymunk gives nan for rotary joints of bodies that do not turn, and where both bodies are outside the space.
        held = [b for c in self.space.constraints for b in (c.a, c.b)]
        if not any(math.isinf(b.moment) or b.space is None for b in held if b is not self.space.static_body):
            self.space.step(DT)

    def bad(self) -> None:
        """What is refused changes nothing."""
        before = state(self.space)
        try:
            self.stepper.step(math.nan)
        except ValueError:
            pass
        else:
            raise AssertionError("nan was accepted")
        assert state(self.space) == before

    def step(self) -> None:
        before = state(self.space)
        try:
            report = self.stepper.step(DT)
        except ValueError:
            assert state(self.space) == before
            raise
        self.steps += 1
        for body in self.space.bodies:
            assert all(math.isfinite(v) for v in (*body.position, *body.velocity, body.angle, body.angular_velocity))
        assert self.space.static_body.position == (0.0, 0.0)
        book = report.ledger
        assert book is not None
        now = ep.measure(self.space)
        scale = 1.0 + now.kinetic + abs(now.potential) + abs(book.external) + abs(book.change)
        assert abs(book.residual) <= 1e-9 * scale, book
        for loss in (book.restitution, book.friction, book.damping):
            assert loss >= -self.gain * scale, book

    def play(self, length: int) -> None:
        actions: tuple[Callable[[], None], ...] = (
            self.add, self.add, self.add, self.step, self.step, self.step, self.step, self.remove, self.remove_shape,
            self.teleport, self.drive, self.push, self.edit, self.turn_kind, self.set_space, self.listen,
            self.functions,
            self.after, self.ask, self.save, self.native, self.bad,
        )  # fmt: skip
        if self.joints:
            actions += (self.join, self.join, self.part)
        for _ in range(length):
            action: Callable[[], None] = self.one(actions)
            self.chance.told(f"{action.__name__}:")
            action()
        for _ in range(3):
            self.step()


def _slow(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    pymunk.Body.update_velocity(body, (0.0, -1.0), 0.95 * damping, dt)
