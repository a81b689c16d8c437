"""Describe: the modelled features of a space in one line."""

from __future__ import annotations

import numpy as np

from ..model.joints import GROOVE, MOTOR, RATCHET, ROTARY_LIMIT, ROTARY_SPRING, SLIDE, SPRING
from .bodies import ANGULAR_VELOCITY, FORCE, TORQUE
from .joints import JointRows
from .world import World


def describe(world: World) -> str:
    """The features of the present space that are modelled."""
    bodies = world.bodies
    state = bodies.gather()  # not into the arrays of the world: a function of the program may ask within a step
    state = world.state if state is None else state
    owner = world.LINK["owner"]
    moving = owner < len(world.BODY) - 1
    disks = int(np.count_nonzero(world.centred & (owner < world.dynamic)))
    others = int(np.count_nonzero(moving)) - disks
    pulled = any(world.gravity) or state[:, FORCE].any() or (others > 0 and state[:, TORQUE].any())
    turns = state[:, ANGULAR_VELOCITY].any() or state[:, TORQUE].any()
    shapes = f"{disks} disks" + (f", {others} other moving shapes" if others else "")
    parts = [
        f"{shapes}, {int(np.count_nonzero(~moving))} walls",
        "gravity or forces" if pulled else "no forces",
        "rotation with contact arms" if others else "free rotation" if turns else "no rotation",
        "loss" if (world.SHAPE["elasticity"] < 1.0).any() else "elastic",
    ]
    if (world.SHAPE["friction"] > 0.0).any():
        parts.append("friction")
    if world.SHAPE["surface_x"].any() or world.SHAPE["surface_y"].any():
        parts.append("moving surfaces")
    if pulled or parts[-1] != "elastic":
        parts.append("sustained contacts")
    if world.joints is not None:
        parts.append(_joints(world.joints))
    if bodies.asleep.any():
        asleep = int(np.count_nonzero(bodies.asleep))
        parts.append(f"{asleep} of {asleep + int(np.count_nonzero(bodies.dynamic))} bodies asleep")
    if world.damping != 1.0:
        parts.append("damping")
    if world.hooks.any_body:
        parts.append("functions of bodies")
    if world.joints is not None and world.joints.calls_back():
        parts.append("functions of constraints")
    if world.collisions:
        parts.append("collision handlers, by a rehearsal")
    return "; ".join(parts)


def _joints(joints: JointRows) -> str:
    """Numbers of constraints by kind, the most frequent first; whether there are limits, motors, springs and bounded
    forces; the order of accuracy."""
    joints.refresh()
    names = [type(item).__name__ for item in joints.items]
    kinds = sorted(set(names), key=lambda kind: (-names.count(kind), kind))
    text = f"{len(names)} joints ({', '.join(f'{names.count(kind)} {kind}' for kind in kinds)})"
    kind, damped = joints.joint["kind"], joints.joint["damping"] != 0.0
    having = [
        ("limits", np.isin(kind, (SLIDE, GROOVE, ROTARY_LIMIT, RATCHET))),
        ("motors", kind == MOTOR),
        ("springs", np.isin(kind, (SPRING, ROTARY_SPRING))),
        ("limited forces", (joints.joint["finite_force"] != 0) & (kind != MOTOR)),
    ]
    lossy = (joints.joint["finite_force"] != 0) | (kind == MOTOR) | (np.isin(kind, (SPRING, ROTARY_SPRING)) & damped)
    order = "order 4, 2 in contact and at limits" if not lossy.any() else "order 4 where nothing dissipates, else 2"
    if lossy.all():
        order = "order 2"
    return ", ".join([text, *(word for word, which in having if which.any()), order])
