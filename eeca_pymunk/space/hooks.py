"""Hooks: functions that a program has set for bodies and constraints of a space, called once a step.

Velocity and position functions are called with the dt of the step. What any of them adds or removes waits for the end
of the step (`private.locked`). The order of the others is

1. in the rehearsal (`rehearsal.py`), if there are collision handlers: `pre_solve` of constraints, and the handlers;
2. without a rehearsal: `pre_solve` of constraints, before the step;
3. after the step: `post_solve` of constraints, which can read the impulses of the step; then, if there are such
   functions, the `post_solve` of handlers, because pymunk calls them in this order.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property, partial
from typing import Any

import pymunk

from ..arrays import FloatArray
from .bodies import Bodies
from .joints import JointRows
from .private import functions as private_functions
from .private import joints as private_joints
from .private import shapes as private_shapes
from .private import spaces as private


class Hooks:
    """The functions of a space and its bodies.

    Args:
        joints: the constraints of the space, None if it has none.
        steered, moved: how many bodies have a velocity function, and a position function.

    Attributes:
        any_body: whether any body has such a function.  late: calls of handlers' `post_solve` that `after` makes.
    """

    def __init__(self, space: pymunk.Space, bodies: Bodies, joints: JointRows | None, steered: int, moved: int) -> None:
        self.space, self.bodies, self.joints = space, bodies, joints
        self.steered, self.moved, self.any_body = steered, moved, steered + moved > 0
        self.late: list[Callable[[], None]] = []
        self._pushes: list[tuple[pymunk.Body, list[float]]] = []

    def none_within_steps(self) -> bool:
        """Whether steps of pymunk would call no function of a body or constraint, and could change no velocity of a
        body that no step moves."""
        joints = self.joints
        calls = joints is not None and (joints.partners.items or joints.calling or joints.with_law)
        return not (self.any_body or calls)

    def before(self, dt: float) -> None:
        """Call `pre_solve` of the constraints: of all if there is no rehearsal, else of those whose first body is
        outside the space, which pymunk's step does not call (it warns instead)."""
        if self.joints is not None:
            collisions = bool(private.handlers(self.space))
            with private.locked(self.space), private_joints.TimeStep(self.space, dt):
                for item in self.joints.before:
                    # Another function may have taken it away.
                    if (not collisions or item.a.space is None) and item.pre_solve is not None:
                        item.pre_solve(item, self.space)
        self.__dict__.pop("_settings", None)  # the functions may have changed them

    def after(self, dt: float) -> None:
        """Call `post_solve` of the constraints, then the delayed calls of handlers."""
        with private.locked(self.space), private_joints.TimeStep(self.space, dt):
            for item in () if self.joints is None else self.joints.after:
                if item.post_solve is not None:
                    item.post_solve(item, self.space)
            late, self.late = self.late, []
            for call in late:
                call()

    def later(self, function: Callable[..., Any]) -> Callable[..., None]:
        """A function that records its arguments, with which `after` calls `function`."""
        return lambda *arguments: self.late.append(partial(function, *arguments))

    @cached_property
    def _steered(self) -> list[pymunk.Body]:
        return [self.bodies.items[row] for row in self.bodies.velocity_hooks.tolist()] if self.steered else []

    @cached_property
    def _moved(self) -> list[pymunk.Body]:
        return [self.bodies.items[row] for row in self.bodies.position_hooks.tolist()] if self.moved else []

    def velocity_changes(self, dt: float) -> list[tuple[float, float, float]]:
        """Changes of velocity (2) and spin by the velocity functions within dt; the bodies are restored."""
        gravity, damping = self._settings
        with private.locked(self.space), private_joints.TimeStep(self.space, dt):
            return private_functions.velocity_changes(self._steered, gravity, damping**dt, dt)

    @cached_property
    def _settings(self) -> tuple[pymunk.Vec2d, float]:
        """Gravity and damping of the space; the properties are slow."""
        return self.space.gravity, self.space.damping

    def note_forces(self, changes: FloatArray) -> None:
        """Note forces and torques (N, 9)[:, 6:] that functions after the motion give: they act in the next step, and
        `push` writes them once those of this step are reset."""
        given = zip(self.bodies.items, changes[:, 6:].tolist(), strict=True)
        self._pushes += [(body, force) for body, force in given if any(force)]

    def push(self) -> None:
        """Exert the forces of `note_forces`."""
        pushes, self._pushes = self._pushes, []
        for body, (x, y, torque) in pushes:
            body.force, body.torque = pymunk.Vec2d(x, y) + body.force, body.torque + torque

    def prepare_positions(self) -> None:
        """Before `positions`: forces that a function gives are seen if there are none, and `update_position` must not
        apply the corrections of overlaps of a rehearsal."""
        private_shapes.forget_corrections(private.pointers(self._moved))
        for body in self._moved:
            body.force, body.torque = (0.0, 0.0), 0.0

    def positions(self, state: FloatArray, end: FloatArray, dt: float) -> None:
        """Call the position functions of the bodies at `state` (N, 9), each with the mean velocity that leads to `end`
        (N, 9) within dt, and write the resulting poses to `end`, and by how much they change these velocities."""
        for row, body in zip(self.bodies.position_hooks, self._moved, strict=True):
            function = private.position_function(body) or pymunk.Body.update_position
            x, y, angle = state[row, :3].tolist()
            to_x, to_y, to_angle = end[row, :3].tolist()
            way_x, way_y = to_x - x, to_y - y
            kx, ky = body.center_of_gravity
            if kx != 0.0 or ky != 0.0:
                c, s = math.cos(to_angle) - math.cos(angle), math.sin(to_angle) - math.sin(angle)
                way_x, way_y = way_x + (c * kx - s * ky), way_y + (s * kx + c * ky)
            body.velocity, body.angular_velocity = (way_x / dt, way_y / dt), (to_angle - angle) / dt
            if (*body.position, body.angle) != (x, y, angle):
                # A rehearsal of collisions has moved the body as pymunk does.
                body.angle, body.position = angle, (x, y)
            mean = *body.velocity, body.angular_velocity
            with private.locked(self.space), private_joints.TimeStep(self.space, dt):
                function(body, dt)
            end[row, :3] = (*body.position, body.angle)
            given = *body.velocity, body.angular_velocity
            if given != mean:
                end[row, 3:6] += [new - old for new, old in zip(given, mean, strict=True)]

    @cached_property
    def silent(self) -> private_functions.WithoutFunctions:
        """Within this block pymunk does not call velocity and position functions."""
        return private_functions.WithoutFunctions(self._steered, self._moved)
