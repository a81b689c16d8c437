"""Random compositions: bodies of many kinds and masses in a container that turns and shakes, and the laws that hold.

`Composition` draws a scene and plays it: thin and thick shapes, masses 1 : 10 000, moments that are infinite, lengths
from 1 mm to 50 m, steps of 1/240 to 1/10 s, with gravity or without; joints and bounded motors on request. Laws:

* all is finite; the ledger closes to 1e-11 of the scale of energy, and its losses are not negative by more than that;
* in a container that rests energy never rises without joints that drive;
* what comes from outside is no more than what acts from there can do (`outside.py`);
* nobody leaves the container, by more than a part of his size, but whom joints lead out (`led.py`), or have led so far
  that his centre is beyond a wall, which then keeps him outside;
* a step of up to 1/30 s takes no longer than 20 ms of processor time, or 100 native steps; a longer one as much for
  each 1/30 s. Steps that do are repeated, as the machine may have been busy, and scenes that have one are counted: a
  soak prints their number, tests measure no times. Events spend their budget only;
* saved and loaded half-way the run goes on bit by bit;
* the contacts of a report change the momentum of each body by what it changes, without joints and functions that push;
* time goes on: not `STANDS` steps in a row leave all that moves where it is;
* joints of a step that has converged hold, and none exceeds its `max_force` (`joined.py`).
"""

from __future__ import annotations

import math
import pickle
import time
from dataclasses import dataclass
from random import Random

import numpy as np
import pymunk

import eeca_pymunk as ep

from .joined import BOUND, HOLDS, OFF, apart, join, may_contradict, overdone, reach
from .led import kept_out, led_out
from .outside import Outside

LENGTHS = (1e-3, 3e-2, 1.0, 10.0, 50.0)
STEPS = (1 / 240, 1 / 60, 1 / 30, 1 / 10)
LONGEST, NATIVE, SHORT = 0.02, 100, 1 / 30  # s of a step, or native steps, of steps of up to SHORT
REPEATS = 12  # of a step that is too long: processor times vary by half on machines that others share
CLOSES = 1e-11
CHANGES = 1e-12  # by which the change of a ledger may differ from that of the space's own energy, over the scale
OVERSPENT = 1.5  # work of a step whose budget is spent, over the budget: the last event may go beyond
STANDS = 5
ADDS_UP = 2e-2  # of all its impulses
PUT_TO_REST = 0.5  # of g dt: how fast a body may be that a step puts to rest, until it is hit
ROUND_OFF = 2.3e-16
SPRING_ROUND_OFF = 16.0 * ROUND_OFF
OUT, BEYOND = 0.5, 1e-3  # of a body's least size: how far it may be outside; how far the wall does not keep it inside


class Broken(AssertionError):
    """A law that does not hold."""


@dataclass
class Found:
    """What a composition came to: longest step (s), steps that have not converged, largest loss below 0, over the scale
    of energy; how far joints are apart, over the length of the scene, and now, over their component (`reach`); steps in
    a row that nothing has moved in; whether a step took too long."""

    longest: float = 0.0
    unconverged: int = 0
    below: float = 0.0
    apart: float = 0.0
    stands: int = 0
    off: float = 0.0
    late: int = 0


def stored(space: pymunk.Space) -> float:
    """Energy (J) of the springs."""
    energy = 0.0
    for spring in space.constraints:
        if isinstance(spring, pymunk.DampedSpring):
            ends = spring.a.local_to_world(spring.anchor_a), spring.b.local_to_world(spring.anchor_b)
            energy += 0.5 * spring.stiffness * (ends[0].get_distance(ends[1]) - spring.rest_length) ** 2
        elif isinstance(spring, pymunk.DampedRotarySpring):
            energy += 0.5 * spring.stiffness * (spring.b.angle - spring.a.angle + spring.rest_angle) ** 2
    return energy


class Composition:
    """The scene of a seed.

    Args:
        joints: whether bodies are joined, some by motors of bounded force.
        thin: whether there are planks and rods, and segments without width.
    """

    def __init__(self, seed: int, joints: bool = False, thin: bool = True) -> None:
        self.drawn = seed, joints, thin
        self.random = R = Random(seed)
        self.kinds = ("disk", "box", "polygon", *(("thin", "rod", "plank") if thin else ()))
        self.length = L = R.choice(LENGTHS)
        self.dt = self.pace = R.choice(STEPS)
        self.space = space = pymunk.Space()
        space.gravity = 0.0, R.choice((0.0, -9.81))
        self.turns = R.random() < 0.6
        self.half = 5.0 * L
        self.box = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        self.rounding = R.choice((0.0, 0.0, 0.1 * L))
        elastic, rough = R.choice((0.0, 0.5, 1.0)), R.choice((0.0, 0.5, 1.0))
        corners = [(-self.half, -self.half), (self.half, -self.half), (self.half, self.half), (-self.half, self.half)]
        walls = [
            pymunk.Segment(self.box, p, q, self.rounding)
            for p, q in zip(corners, corners[1:] + corners[:1], strict=True)
        ]
        for wall in walls:
            wall.elasticity, wall.friction = R.choice((1.0, elastic)), rough
        space.add(self.box, *walls)
        self.bodies: list[pymunk.Body] = []
        self.led: set[pymunk.Body] = set()
        self.sizes: list[float] = []
        self.reached: dict[pymunk.Constraint, float] = {}  # `reach` at the end of the last step
        self.matter = elastic, rough
        places = [(x, y) for x in range(-3, 4, 2) for y in range(-3, 4, 2)]
        for x, y in R.sample(places, R.randint(2, 12)):
            self._add(x * L, y * L)
        if joints:
            self._join()
        self._vary()
        self.stepper = ep.EECA(space)

    @property
    def gentle(self) -> bool:
        """Whether what falls comes less far in a step than a quarter of the length of the scene."""
        return abs(self.space.gravity[1]) * self.dt * self.dt <= 0.25 * self.length

    @property
    def gains(self) -> bool:
        """Whether something may add energy."""
        return self.turns or bool(self.space.constraints)

    @property
    def pushed(self) -> bool:
        """Whether functions of the program push bodies."""
        return False

    def _vary(self) -> None:
        """Add what else there is, before the stepper reads the scene."""

    def _add(self, x: float, y: float) -> None:
        R, L = self.random, self.length
        elastic, rough = self.matter
        mass = 10.0 ** R.uniform(0.0, 4.0) * L * L
        size = R.uniform(0.2, 0.7) * L
        kind = R.choice(self.kinds)
        moment = math.inf if R.random() < 0.1 else 0.4 * mass * size * size
        body = pymunk.Body(mass, moment)
        body.position, body.angle = (x, y), R.uniform(-3.0, 3.0)
        speed = R.choice((0.0, 1.0, 5.0)) * L
        body.velocity = R.uniform(-speed, speed), R.uniform(-speed, speed)
        spin = R.uniform(-3.0, 3.0)
        body.angular_velocity = 0.0 if math.isinf(moment) else spin  # a wheel that nothing stops drives others
        shape: pymunk.Shape
        least = size
        if kind == "disk":
            shape = pymunk.Circle(body, size)
        elif kind == "box":
            shape = pymunk.Poly.create_box(body, (2 * size, size), R.choice((0.0, 0.05 * L)))
        elif kind == "plank":
            shape, least = pymunk.Poly.create_box(body, (2 * size, 0.05 * size)), 0.05 * size
        elif kind == "polygon":
            n = R.randint(3, 8)
            shape = pymunk.Poly(
                body, [(size * math.cos(2 * math.pi * k / n), size * math.sin(2 * math.pi * k / n)) for k in range(n)]
            )
        else:
            shape = pymunk.Segment(body, (-size, 0.0), (size, 0.0), 0.0 if kind == "thin" else 0.05 * L)
        shape.elasticity, shape.friction = R.choice((1.0, elastic)), rough
        self.space.add(body, shape)
        self.bodies.append(body)
        self.sizes.append(max(least, 0.1 * L))

    def _join(self) -> None:
        R = self.random
        for a, b in zip(self.bodies, self.bodies[1:], strict=False):
            if R.random() < 0.5:
                self.space.add(join(R, a, b, self.length, a.mass))
                if R.random() < 0.3:
                    motor = pymunk.SimpleMotor(a, b, R.uniform(-3, 3))
                    motor.max_force = a.mass * self.length**2 * R.choice((0.1, 1.0, 10.0))
                    self.space.add(motor)
        for _ in range(R.choice((0, 0, 1, 2))):
            a, b = R.sample([*self.bodies, self.box], 2)
            if b is self.box or a is self.box or R.random() < 0.5:
                joint = join(R, a, b, self.length, min(a.mass, b.mass))
                joint.collide_bodies = True  # what hangs on the container stays in it
                self.space.add(joint)

    def span(self, k: int) -> float:
        """The dt of step k."""
        return self.dt

    def edit(self, k: int, found: Found) -> bool:
        """What a program does before step k; whether it changes the scene."""
        return False

    def moves(self, state: list[tuple[float, ...]]) -> bool:
        """Whether a body has a velocity that takes it elsewhere in a step."""
        return any(self.leaves(row) for row in state)

    def leaves(self, row: tuple[float, ...]) -> bool:
        """Whether a body's velocity changes its pose in a step, by more than is rounded away, of places or of what
        gravity changes of velocities."""
        slow, sizes = ROUND_OFF * abs(self.space.gravity[1]) * self.dt, (1.0, 1.0, self.length)
        moves = zip(row[:3], row[3:], sizes, strict=True)
        return any(at + self.dt * speed != at and abs(speed) * size > slow for at, speed, size in moves)

    def drive(self, k: int) -> None:
        """Shake and turn the container."""
        if self.turns:
            t, L = k * self.pace, self.length
            self.box.velocity = L * math.cos(3.0 * t), L * math.sin(5.0 * t)
            self.box.angular_velocity = math.sin(t)

    def state(self) -> list[tuple[float, ...]]:
        """Poses and velocities of all bodies."""
        return [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in self.bodies]

    def play(self, steps: int = 120) -> Found:
        """Take the steps; `Broken` says which law does not hold."""
        found, energies = Found(), [ep.measure(self.space).energy]
        saved: bytes | None = None
        half: list[list[tuple[float, ...]]] = []
        before: list[tuple[float, ...]] = []
        for k in range(steps):
            self.dt = self.span(k)
            if self.edit(k, found):
                energies.append(ep.measure(self.space).energy)
                before, saved, half = [], None, []
            if k == steps // 2:
                saved = self.saved()
            self.drive(k)
            outside = Outside(self.space, self.box, self.pushed)
            moved = [(b, b.velocity) for b in self.bodies if not b.is_sleeping]
            start = self.saved() if found.longest > 0.5 * self._longest() else None
            clock = time.thread_time()
            report = self.stepper.step(self.dt)
            taken = time.thread_time() - clock
            if taken > self._longest() and found.late == 0:
                taken, found.late = self._again(start or self._replayed(k))
            found.longest = max(found.longest, taken)
            found.unconverged += not report.converged
            state = self.state()
            if saved is not None:
                half.append(state)
            self._check(k, report, state, energies, found, outside)
            self._check_joints(k, report, found)
            self._check_impulses(k, report, moved)
            found.stands = found.stands + 1 if state == before and self.moves(state) else 0
            if found.stands >= STANDS:
                raise Broken(f"step {k}: time stands still")
            before = state
        if saved is not None and not self.turns:
            space, stepper = pickle.loads(saved)
            again = [b for b in space.bodies if b.body_type == pymunk.Body.DYNAMIC]
            for k, expected in enumerate(half, steps - len(half)):
                stepper.step(self.span(k))
                now = [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in again]
                if now != expected:
                    raise Broken(f"a run that was saved goes another way at step {k}")
        return found

    def _longest(self) -> float:
        """Processor time (s) that a step may take in any case."""
        return LONGEST * max(1.0, self.dt / SHORT)

    def saved(self) -> bytes:
        """What goes on as this run does."""
        return pickle.dumps((self.space, self.stepper))

    def _replayed(self, k: int) -> bytes:
        """The run before step k, played anew."""
        again, found = type(self)(*self.drawn), Found()
        for earlier in range(k + 1):
            again.dt = again.span(earlier)
            again.edit(earlier, found)
            again.drive(earlier)
            if earlier < k:
                again.stepper.step(again.dt)
        return again.saved()

    def _again(self, start: bytes) -> tuple[float, int]:
        """The processor time (s) of the next step of a saved run, the least of REPEATS, and 1 if it is too long."""
        least = limit = math.inf
        for _ in range(REPEATS):
            _, stepper = pickle.loads(start)
            native, _ = pickle.loads(start)
            stepper.current()  # reads the space, as a run has done before
            clock = time.thread_time()
            stepper.step(self.dt)
            least = min(least, time.thread_time() - clock)
            clock = time.thread_time()
            native.step(self.dt)
            limit = max(1.0, NATIVE * (time.thread_time() - clock) / LONGEST) * self._longest()
            if least <= limit:
                return least, 0
        return least, 1

    def _check_joints(self, k: int, report: ep.StepReport, found: Found) -> None:
        before, found.off = found.off, 0.0
        for joint in self.space.constraints:
            off, over = apart(joint, self.length), overdone(joint, self.dt)
            # A step measures errors by the size of the component at its start.
            size, self.reached[joint] = max(self.reached.get(joint, 0.0), now := reach(joint)), now
            held = apart(joint, max(self.length, size))
            found.off, found.apart = max(found.off, held), max(found.apart, off)
            if over > 1.0 + BOUND:
                raise Broken(f"step {k}: {joint} pushes {over:.3g} times max_force")
            if off > OFF and not (may_contradict(joint) and (before > HOLDS or not report.converged)):
                raise Broken(f"step {k}: {joint} is {off:.1e} apart")
            if report.converged and held > HOLDS and before <= HOLDS:
                raise Broken(f"step {k}: {joint} is {off:.1e} apart in a step that has converged")

    def _check_impulses(self, k: int, report: ep.StepReport, moved: list[tuple[pymunk.Body, pymunk.Vec2d]]) -> None:
        if self.space.constraints or self.pushed or any(one.name in ("solves", "contacts") for one in report.unmet):
            return
        contacts, normal = report.contacts, report.contacts.normal
        impulse = report.impulse[:, None] * normal
        impulse += report.friction[:, None] * np.stack([-normal[:, 1], normal[:, 0]], 1)
        for body, velocity in moved:
            if body.is_sleeping or body not in contacts.bodies:
                continue
            i = contacts.bodies.index(body)
            change = body.mass * (body.velocity - velocity - self.dt * pymunk.Vec2d(*self.space.gravity))
            acted = (contacts.body_b == i) * 1.0 - (contacts.body_a == i)
            sizes = float(np.hypot(*impulse.T) @ abs(acted))
            size = sizes + body.mass * (self.dt * abs(self.space.gravity[1]) + ROUND_OFF / CHANGES * velocity.length)
            off = math.hypot(*(acted @ impulse - change))
            slow = velocity.length < PUT_TO_REST * self.dt * abs(self.space.gravity[1])
            off -= body.mass * velocity.length if slow else 0.0
            if sizes > 0.0 and off > ADDS_UP * size:
                raise Broken(f"step {k}: impulses change a momentum by {off / size:.1e} of them more than it changes")

    def _check(
        self,
        k: int,
        report: ep.StepReport,
        state: list[tuple[float, ...]],
        energies: list[float],
        found: Found,
        outside: Outside,
    ) -> None:
        if not np.isfinite(state).all():
            raise Broken(f"step {k}: not finite")
        for unmet in report.unmet:
            if unmet.name == "solves" and unmet.value > OVERSPENT * unmet.limit:
                raise Broken(f"step {k}: work of {unmet.value:.0f} looks, {unmet.limit:.0f} at most")
        now = ep.measure(self.space)
        ledger = report.ledger
        assert ledger is not None
        g = abs(self.space.gravity[1])
        scale = sum(b.mass for b in self.bodies) * g * 10 * self.length + abs(now.kinetic) + abs(ledger.external)
        scale += ledger.restitution + ledger.friction + ledger.damping + abs(energies[-1])
        # At rest without gravity there is no other energy than of velocities that round-off of places gives, and their
        # work against what joints press each other with.
        slow = ROUND_OFF * self.half / self.dt
        noise = slow * (slow * sum(b.mass for b in self.bodies) + sum(abs(c.impulse) for c in self.space.constraints))
        work = outside.most(report, self.dt, True)  # of motors, which exact joints may take up
        if abs(ledger.residual) > noise + CLOSES * (scale + (work if math.isfinite(work) else 0.0)):
            raise Broken(f"step {k}: the ledger is open by {ledger.residual / scale:.1e}")
        least = min(ledger.restitution, ledger.friction, ledger.damping) / max(scale, 1e-300)
        found.below = min(found.below, least)
        if least < -CLOSES and least * scale < -noise:
            raise Broken(f"step {k}: a loss of {least:.1e}, converged {report.converged}")
        change = now.energy - energies[-1]
        if not self.space.constraints and abs(ledger.change - change) > CHANGES * scale:
            raise Broken(f"step {k}: the ledger's change is off by {(ledger.change - change) / scale:.1e}")
        most = outside.most(report, self.dt, True) if found.off <= HOLDS else math.inf
        # The change of what a spring stores has the round-off of all that it stores, and of its length.
        error = noise + CLOSES * scale + SPRING_ROUND_OFF * stored(self.space)
        taken = 0.0 if self.space.constraints else max(0.0, -ledger.external)  # joints may brake: of them, only gains
        if max(ledger.external, taken) > most + error:
            most = outside.most(report, self.dt, False)
        if max(ledger.external, taken) > most + error:
            raise Broken(f"step {k}: {ledger.external / scale:.1e} from outside, {most / scale:.1e} at most")
        if not self.gains and change > noise + CLOSES * scale:
            raise Broken(f"step {k}: energy rises by {change / scale:.1e}")
        energies.append(now.energy)
        for body, size in zip(self.bodies, self.sizes, strict=True):
            x, y = self.box.world_to_local(body.position)
            out = max(abs(x), abs(y)) - self.half - self.rounding
            if out <= BEYOND * size:
                self.led.discard(body)
            elif body not in self.led and (
                led_out(self.space, self.box, body, self.length)
                or kept_out(self.space, self.box, body, self.length, self.half + self.rounding + BEYOND * size)
            ):
                self.led.add(body)
            if out > OUT * size and body not in self.led:
                raise Broken(f"step {k}: {next(iter(body.shapes))} is {out / size:.2g} of its size outside")
