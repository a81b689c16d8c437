"""Hooks: what a user's program has hung into a space, called once a step as pymunk calls it.

Velocity and position functions are called with the real dt. Collision handlers need pymunk's own arbiters: a
*rehearsal* lets pymunk take the step from the same start to where the bodies would fly freely, with its own detection
and solver, so that begin, pre_solve, post_solve and separate come in pymunk's order and with pymunk's numbers. What
they decide (collisions to ignore, restitution, friction, surface velocities, changed velocities) goes into our step,
which then takes its place.

`pre_solve` of constraints comes in its place there too, before our step where there is no rehearsal. `post_solve` of
constraints comes after our step, whose impulses they can read; then so does that of collisions, which come after it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

import numpy as np
import pymunk

from ..arrays import FloatArray, rotated
from ..compiled.records import Rows
from ..model.shapes import Shape
from . import private, private_joints
from .bodies import ANGLE, ANGULAR_VELOCITY, POSITION, VELOCITY, Bodies
from .joints import JointRows
from .shapes import Rules
from .sync import forget_corrections

_PRESS = 1e-7  # part of its height by which a body is pressed on what carries it, in a rehearsal


class Hooks:
    """The functions of a space and its bodies, for one step.

    Args:
        joints: the constraints of the space, None if it has none.

    Attributes:
        velocity, position: rows of the bodies with a function of their own.  steered: (N,) whether it is for velocity.
        collisions: whether the space has collision handlers.
    """

    def __init__(self, space: pymunk.Space, bodies: Bodies, joints: JointRows | None = None) -> None:
        self.space, self.bodies, self.joints = space, bodies, joints
        self.velocity, self.position = bodies.velocity_hooks, bodies.position_hooks
        self.steered = bodies.steered
        self.collisions = bool(private.handlers(space))
        self._change: FloatArray | None = None
        self._late: list[Callable[[], None]] = []

    def before(self) -> None:
        """Call `pre_solve` of the constraints that no rehearsal calls. pymunk calls none whose first body is outside
        the space, and complains."""
        if self.joints is not None:
            with private.locked(self.space):
                for item in self.joints.before:
                    if not self.collisions or item.a.space is None:
                        assert item.pre_solve is not None
                        item.pre_solve(item, self.space)

    def after(self) -> None:
        """Call `post_solve` of the constraints, then that of collisions if it had to wait for this."""
        with private.locked(self.space):
            for item in () if self.joints is None else self.joints.after:
                assert item.post_solve is not None
                item.post_solve(item, self.space)
            for call in self._late:
                call()

    def later(self, function: Callable[..., Any]) -> Callable[..., None]:
        """What lets `after` call a function with the arguments it is called with now."""

        def call(*arguments: Any) -> None:
            self._late.append(lambda: function(*arguments))

        return call

    def change(self, dt: float) -> FloatArray:
        """(k, 3) what the functions add to velocity and spin of their bodies, which keep theirs; called once a step."""
        if self._change is None:
            gravity, damping = self.space.gravity, self.space.damping**dt
            self._change = np.empty((len(self.velocity), 3))
            for i, row in enumerate(self.velocity):
                body = self.bodies.items[row]
                velocity, spin = body.velocity, body.angular_velocity
                function = private.velocity_function(body)
                assert function is not None  # this is one of the bodies that have one
                try:
                    function(body, gravity, damping, dt)
                    self._change[i] = (*(body.velocity - velocity), body.angular_velocity - spin)
                finally:
                    body.velocity, body.angular_velocity = velocity, spin
        return self._change

    def positions(self, state: FloatArray, end: FloatArray, dt: float) -> None:
        """Let the functions move their bodies from `state` with the velocity that leads to `end`, which they change."""
        for row in self.position:
            body = self.bodies.items[row]
            function = private.position_function(body)
            assert function is not None
            way, turn = end[row, POSITION] - state[row, POSITION], end[row, ANGLE] - state[row, ANGLE]
            body.velocity, body.angular_velocity = tuple(way / dt), float(turn / dt)
            function(body, dt)
            end[row, POSITION], end[row, ANGLE] = body.position, body.angle

    @contextmanager
    def silent(self) -> Iterator[None]:
        """Within, pymunk's default functions stand in for the bodies' own."""
        items = self.bodies.items
        velocity = [(items[i], private.velocity_function(items[i])) for i in self.velocity]
        position = [(items[i], private.position_function(items[i])) for i in self.position]
        try:
            for body, _ in velocity:
                private.replace_functions(body, pymunk.Body.update_velocity, None)
            for body, _ in position:
                private.replace_functions(body, None, pymunk.Body.update_position)
            yield
        finally:
            for body, function in velocity:
                private.replace_functions(body, function, None)
            for body, place in position:
                private.replace_functions(body, None, place)


class Rehearsal:
    """pymunk's own step from the start of ours, for its collision handlers.

    Attributes:
        before: (N, 9) the state of the start with what begin and pre_solve have changed in it.
    """

    def __init__(self, space: pymunk.Space, hooks: Hooks, state: FloatArray) -> None:
        self.space, self.hooks, self.bodies = space, hooks, hooks.bodies
        self._state = state
        self.before = state.copy()
        self._after = np.zeros_like(state)
        self._failure: BaseException | None = None

    def run(self, free: FloatArray, dt: float) -> FloatArray:
        """Take pymunk's step to the (N, 9) state `free`; what post_solve and separate change (N, 9). Raises what a
        handler raises, once pymunk has finished.

        pymunk moves bodies first, and accelerates them where they have come to. So they start from where their
        velocities, which handlers see and contacts feel, lead there.
        """
        going, moves = self._state.copy(), ~self.bodies.static
        going[:, ANGLE] = free[:, ANGLE] - dt * self._state[:, ANGULAR_VELOCITY]
        going[:, POSITION] = self.bodies.centers(free) - dt * self._state[:, VELOCITY] + self._pressed()
        going[:, POSITION] -= rotated(self.bodies.center_of_gravity, going[:, ANGLE])
        going[~moves] = self._state[~moves]
        self.bodies.scatter(going, unchanged=True)
        with self.hooks.silent(), self._watched():
            private.step_alone(self.space, dt)
        if self._failure is not None:
            raise self._failure
        return self._after

    def _pressed(self) -> FloatArray:
        """(N, 2) way by which bodies go farther along gravity, the more the higher they are.

        What stands on one another here is at a distance of 0, give or take round-off, and pymunk, in whose own steps it
        sinks in, would begin and end such contacts at random.
        """
        gravity = np.array(self.space.gravity)
        pull = float(np.hypot(*gravity))
        way = np.zeros((len(self.bodies), 2))
        moves = self.bodies.dynamic
        if pull > 0.0 and moves.any():
            down = gravity / pull
            depth = self._state[moves, POSITION] @ down
            way[moves] = _PRESS * (depth.max() - depth)[:, None] * down
        return way

    @contextmanager
    def _watched(self) -> Iterator[None]:
        """Within, the handlers' functions tell what they change and what they raise."""
        handlers, joints = private.handlers(self.space), self.hooks.joints
        functions = [(h, phase, getattr(h, phase)) for h in handlers for phase in private.PHASES]
        functions = [(h, phase, f) for h, phase, f in functions if f is not None]
        with ExitStack() as stack:
            if joints is not None:
                mute = [item for item in joints.calling if item.pre_solve is None or item.a.space is None]
                stack.enter_context(joints.partners.kept())
                stack.enter_context(private_joints.silent(mute))
                stack.enter_context(private_joints.with_laws(joints.own, joints.laws()))
                stack.enter_context(self._watched_joints([item for item in joints.before if item not in mute]))
            try:
                for handler, phase, function in functions:
                    changes = self.before if phase in private.PHASES[:2] else self._after
                    watched = self._watch(function, changes)
                    if phase == private.PHASES[2] and joints is not None and joints.after:
                        watched = self.hooks.later(function)
                    setattr(handler, phase, watched)
                yield
            finally:
                for handler, phase, function in functions:
                    setattr(handler, phase, function)

    @contextmanager
    def _watched_joints(self, items: Sequence[pymunk.Constraint]) -> Iterator[None]:
        """Within, `pre_solve` of constraints tells what it changes and raises, and `post_solve` is not called."""
        functions = [(item, item.pre_solve, item.post_solve) for item in items]
        try:
            for item, before, after in functions:
                assert before is not None
                nothing = None if after is None else _nothing
                private_joints.replace_functions(item, self._watch(before, self.before), nothing)
            yield
        finally:
            for item, before, after in functions:
                private_joints.replace_functions(item, before, after)

    def _watch(self, function: Callable[..., Any], changes: FloatArray) -> Callable[..., None]:
        def call(*arguments: Any) -> None:
            if self._failure is not None:
                return
            was = self.bodies.gather()
            try:
                function(*arguments)
            except BaseException as error:
                # It would end in pymunk's C code, which cannot pass it on.
                self._failure = error
            now = self.bodies.gather()
            if was is not None and now is not None:
                # pymunk makes nan of the spins of bodies that do not turn and that gears hold: ours does not.
                changes[:] += np.where(np.isnan(was), 0.0, now - was)

        return call

    def rules(self, shapes: Sequence[pymunk.Shape], SHAPE: Rows[Shape], smooth: bool) -> Rules:
        """What the arbiters of the step say of pairs of these shapes, which are the rows of SHAPE."""
        return Rules.said(private.arbiters(self.space), shapes, SHAPE, smooth)

    def finish(self, bodies: Bodies) -> None:
        """What pymunk does when its step has ended: shapes where the bodies are, additions, removals, callbacks."""
        space = self.space
        forget_corrections(space)
        for body in bodies.items:
            if body.body_type != pymunk.Body.STATIC:
                space.reindex_shapes_for_body(body)
        private.finish_step(space)


def _nothing(*arguments: Any) -> None:
    pass
