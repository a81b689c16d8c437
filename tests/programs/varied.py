"""Random compositions with more of what a program does: see `FEATURES`, each in a share of the scenes.

The scene of a seed is that of `Composition`, so that its failures reduce: what is added is drawn by another generator.
The laws are the same, and:

* native steps in between change no law, and the step that takes over starts from the energy that pymunk's space has;
* positions and velocities that are set back, with `refresh` or by `set_state`, give the same path bit by bit;
* what sleeps does not move, and handlers are called.
"""

from __future__ import annotations

import math
from random import Random
from typing import Any

import pymunk

import eeca_pymunk as ep

from .compositions import STEPS, Broken, Composition, Found

FEATURES: dict[str, float] = {
    "compound": 0.35,  # up to three shapes on a body, some of them sensors
    "sleep": 0.2,  # a threshold, `body.sleep`, `activate`
    "handlers": 0.25,  # count; some pairs of bodies pass through each other
    "functions": 0.2,  # of velocities and positions, that do as pymunk's
    "drag": 0.1,  # functions of velocities that damp
    "set back": 0.2,
    "edits": 0.25,  # bodies and shapes come and go
    "native": 0.15,
    "spans": 0.3,  # dt of 1/240 to 1/10 s, another in each step
    "belts": 0.15,  # walls with a surface velocity
    "many": 0.03,  # up to 200 bodies
    "welds": 0.15,  # bodies that a pivot and a gear hold on the ground, or on one another, while the box rests
}
AGAIN = 6  # steps that are repeated
PASS, COUNTED = 7, 8  # collision types


CALLS: list[bool] = []


def count(arbiter: pymunk.Arbiter, space: pymunk.Space, data: dict[Any, Any]) -> None:
    """Count a call."""
    CALLS.append(arbiter.is_first_contact)


def reject(arbiter: pymunk.Arbiter, space: pymunk.Space, data: dict[Any, Any]) -> None:
    """Let two shapes pass through each other."""
    arbiter.process_collision = False


def usual(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    """What pymunk does."""
    pymunk.Body.update_velocity(body, gravity, damping, dt)


def damped(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    """Drag."""
    pymunk.Body.update_velocity(body, gravity, 0.9**dt, dt)


def onward(body: pymunk.Body, dt: float) -> None:
    """What pymunk does."""
    pymunk.Body.update_position(body, dt)


class Varied(Composition):
    """The composition of a seed, with some of FEATURES; `has` names them."""

    def _vary(self) -> None:
        seed = self.drawn[0]
        self.chance = C = Random(f"varied {seed}")
        self.has = {name for name, share in FEATURES.items() if name != "welds" and C.random() < share}
        self.seed, self.calls = seed, 0
        self.extra: list[pymunk.Shape] = []
        self.away: list[pymunk.Shape] = []
        if self.space.constraints:
            self.has -= {"native", "many"}  # native steps leave joints apart
        if "sleep" in self.has:
            # Idle times are pymunk's. Its own step has been seen not to return from a scene with sleeping bodies.
            self.has -= {"set back", "native"}
        if "many" in self.has:
            self._fill()
        for name in ("compound", "handlers", "functions", "drag", "sleep", "belts"):
            if name in self.has:
                getattr(self, "_" + name)()
        self._weld(Random(f"welded {seed}"))

    def _weld(self, C: Random) -> None:
        """Weld up to three bodies, drawn by a generator of their own."""
        if C.random() > FEATURES["welds"] or not self.space.constraints or self.turns:
            return
        self.has.add("welds")
        base = self.space.static_body
        for body in C.sample(self.bodies, min(len(self.bodies), C.randint(1, 3))):
            gear = pymunk.GearJoint(base, body, body.angle - base.angle, 1.0)
            self.space.add(pymunk.PivotJoint(base, body, tuple(body.position)), gear)
            base = C.choice((base, body))

    def _fill(self) -> None:
        """A larger box, with up to 200 bodies."""
        C, old = self.chance, [*self.box.shapes]
        self.half = 15.0 * self.length
        self.space.remove(*old)
        corners = [pymunk.Vec2d(self.half, self.half).rotated(0.5 * math.pi * k) for k in range(5)]
        for wall, p, q in zip(old, corners, corners[1:], strict=False):
            new = pymunk.Segment(self.box, p, q, self.rounding)
            new.elasticity, new.friction = wall.elasticity, wall.friction
            self.space.add(new)
        places = [(x, y) for x in range(-13, 14, 2) for y in range(-13, 14, 2) if max(abs(x), abs(y)) > 3]
        for x, y in C.sample(places, C.randint(30, len(places))):
            self._add(x * self.length, y * self.length)

    def _shape(self, body: pymunk.Body) -> pymunk.Shape:
        """Another shape of a body, within its length."""
        C, L = self.chance, self.length
        x, y, r = C.uniform(-0.3, 0.3) * L, C.uniform(-0.3, 0.3) * L, C.uniform(0.1, 0.3) * L
        shape: pymunk.Shape = pymunk.Circle(body, r, (x, y))
        if C.random() < 0.5:
            shape = pymunk.Poly(body, [(x - r, y - r), (x + r, y - r), (x, y + r)], None, C.choice((0.0, 0.02 * L)))
        old = next(iter(body.shapes))
        shape.elasticity, shape.friction, shape.sensor = old.elasticity, old.friction, C.random() < 0.15
        return shape

    def _compound(self) -> None:
        for body in self.bodies:
            for _ in range(self.chance.choice((0, 0, 1, 2))):
                shape = self._shape(body)
                self.space.add(shape)
                self.extra.append(shape)

    def _handlers(self) -> None:
        C, space = self.chance, self.space
        for body in self.bodies:
            kind = C.choice((0, PASS, COUNTED))
            for shape in body.shapes:
                shape.collision_type = kind
        space.on_collision(PASS, PASS, **{C.choice(("begin", "pre_solve")): reject})
        space.on_collision(COUNTED, None, **dict.fromkeys(("begin", "pre_solve", "post_solve", "separate"), count))

    def _functions(self) -> None:
        for body in self.bodies:
            if self.chance.random() < 0.5:
                body.velocity_func = usual
            if self.chance.random() < 0.5:
                body.position_func = onward

    def _drag(self) -> None:
        for body in self.bodies:
            if self.chance.random() < 0.5:
                body.velocity_func = damped

    def _sleep(self) -> None:
        self.space.sleep_time_threshold = self.chance.choice((0.1, 0.5))

    def _belts(self) -> None:
        for wall in self.box.shapes:
            wall.surface_velocity = self.chance.choice((0.0, 0.5, -2.0)) * self.length, 0.0

    def span(self, k: int) -> float:
        if "spans" not in self.has:
            return self.pace
        one = Random(f"{self.seed} {k}").choice(STEPS)
        gentle = abs(self.space.gravity[1]) * one * one <= 0.25 * self.length
        return one if gentle else self.pace

    def moves(self, state: list[tuple[float, ...]]) -> bool:
        return any(self.leaves(row) for row, body in zip(state, self.bodies, strict=True) if not body.is_sleeping)

    @property
    def gains(self) -> bool:
        return super().gains or bool(self.has & {"belts", "drag"})

    @property
    def gentle(self) -> bool:
        """A large box that turns presses its bodies outward by many times their weight."""
        return super().gentle and not ("many" in self.has and self.turns)

    @property
    def pushed(self) -> bool:
        return "drag" in self.has

    def edit(self, k: int, found: Found) -> bool:
        """What belongs to step k, drawn anew so that a repetition does the same."""
        C, done = Random(f"{self.seed} edit {k}"), False
        if "sleep" in self.has and C.random() < 0.1:
            done = self._doze(C)
        if "edits" in self.has and C.random() < 0.15:
            C.choice((self._come, self._go, self._come_shape, self._go_shape))(C)
            done = True
        if "native" in self.has and C.random() < 0.1 and not self._without_width():
            self.drive(k)
            self._native_step()
            done = True
        if "set back" in self.has and k in (0, 20, 40):
            self._set_back(k)
            done = True
        return done

    def _native_step(self) -> None:
        """A short step of pymunk's own. One that adds more energy than all had, as its impulses among thin shapes have
        been seen to do, from 1 J to 1e6 J, is undone."""
        start = [(b.position, b.angle, b.velocity, b.angular_velocity) for b in (self.box, *self.bodies)]
        before = ep.measure(self.space)
        self.space.step(self._short())
        after = ep.measure(self.space)
        if after.energy - before.energy > before.kinetic + sum(b.mass for b in self.bodies) * 9.81 * self.length:
            for body, (place, angle, velocity, spin) in zip((self.box, *self.bodies), start, strict=True):
                body.position, body.angle, body.velocity, body.angular_velocity = place, angle, velocity, spin
                self.space.reindex_shapes_for_body(body)

    def _short(self) -> float:
        """A time in which no point moves as far as half the width of the thinnest plank: in a part of dt gravity and
        fast bodies take small ones through walls, as pymunk's own step has contacts at its end only."""
        way, box = 0.005 * self.length, self.box
        fast = max(b.velocity.length + abs(b.angular_velocity) * self.length for b in self.bodies)
        fast += box.velocity.length + 1.5 * self.half * abs(box.angular_velocity)
        fast += math.sqrt(abs(self.space.gravity[1]) * way)
        return min(0.05 * self.dt, 0.5 * way / max(fast, 1e-300))

    def _without_width(self) -> bool:
        """Whether a rod without width is among walls without width. Two such lines overlap nowhere, so pymunk's step
        has no contact with what lies on a wall, and lets it fall through by g dt^2."""
        rods = (s for b in self.bodies for s in b.shapes if isinstance(s, pymunk.Segment))
        return self.rounding == 0.0 and any(rod.radius == 0.0 for rod in rods)

    def _doze(self, C: Random) -> bool:
        body = C.choice(self.bodies)
        if body.is_sleeping:
            body.activate()
        elif not self.space.constraints and math.isfinite(body.moment):
            body.velocity, body.angular_velocity = (0.0, 0.0), 0.0
            body.sleep()
        return True

    def _free(self, x: float, y: float, size: float) -> bool:
        """Whether a disk is free of everything, in the box, at a place of the box's."""
        place = self.box.local_to_world((x, y))
        return self.space.point_query_nearest(place, size, pymunk.ShapeFilter()) is None

    def _come(self, C: Random) -> None:
        L = self.length
        x, y = C.uniform(-3.0, 3.0) * L, C.uniform(-3.0, 3.0) * L
        if self._free(x, y, 1.5 * L):
            self._add(*self.box.local_to_world((x, y)))

    def _go(self, C: Random) -> None:
        if len(self.bodies) < 3:
            return
        i = C.randrange(len(self.bodies))
        body = self.bodies.pop(i)
        self.sizes.pop(i)
        self.extra = [shape for shape in self.extra if shape.body is not body]
        self.away = [shape for shape in self.away if shape.body is not body]
        self._wake_touching(body)
        joints = [joint for joint in self.space.constraints if body in (joint.a, joint.b)]
        self.space.remove(*joints, *(shape for shape in body.shapes if shape.space is not None), body)

    def _wake_touching(self, body: pymunk.Body) -> None:
        """Wake what was put to sleep as it touched a body: it would keep pymunk's arbiter of shapes that are removed,
        and waking it later would make a pointer to these valid again."""
        body.each_arbiter(lambda arbiter: [s.body.activate() for s in arbiter.shapes if s.body.is_sleeping])

    def _go_shape(self, C: Random) -> None:
        if self.extra:
            shape = self.extra.pop(C.randrange(len(self.extra)))
            self._wake_touching(shape.body)
            self.space.remove(shape)
            self.away.append(shape)

    def _come_shape(self, C: Random) -> None:
        for shape in self.away:
            shape.cache_bb()
            if not any(
                hit.shape is not None and hit.shape.body is not shape.body for hit in self.space.shape_query(shape)
            ):
                self.away.remove(shape)
                self.space.add(shape)
                self.extra.append(shape)
                return

    def _set_back(self, k: int) -> None:
        """Go AGAIN steps on and back, twice: to the start as a program does, which knows no sides of thin shapes that
        overlap; later by `set_state`."""
        paths, everyone = [], [self.box, *self.bodies]
        by_state = k > 0
        if not by_state:
            self.stepper.refresh()
        state = self.stepper.get_state() if by_state else None
        start = [(b.position, b.angle, b.velocity, b.angular_velocity) for b in everyone]
        notches = [(c, c.angle) for c in self.space.constraints if isinstance(c, pymunk.RatchetJoint)]
        for _ in range(3):
            if state is not None:
                self.stepper.set_state(state)
            else:
                for body, (place, angle, velocity, spin) in zip(everyone, start, strict=True):
                    body.position, body.angle, body.velocity, body.angular_velocity = place, angle, velocity, spin
                    self.space.reindex_shapes_for_body(body)
                for ratchet, notch in notches:
                    ratchet.angle = notch
                self.stepper.refresh()
            if len(paths) == 2:
                break
            for more in range(AGAIN):
                self.drive(k + more)
                self.stepper.step(self.span(k + more))
            paths.append(self.state())
        if paths[0] != paths[1]:
            raise Broken(f"step {k}: set back {'by set_state' if by_state else 'by hand'} it goes another way")
