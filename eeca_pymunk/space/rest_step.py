"""The rest step: pymunk's own step, in which nothing moves (`sync.py`)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import TypeAlias

import pymunk

from .joints import JointRows
from .private import joints as private_joints
from .private import rest as private_rest
from .private.joints import clear_max_forces, restore_max_forces, restore_motions, silent, with_laws

# Returns those of given constraints whose bodies are all awake.
Awake: TypeAlias = Callable[[Sequence[pymunk.Constraint]], list[pymunk.Constraint]]


@contextmanager
def without_joints(space: pymunk.Space, forces: bool) -> Iterator[None]:
    """Within this block steps of pymunk call no functions of constraints, and what no step moves keeps its velocities:
    also for constraints that the program has added, or whose bodies it has changed, since the last step of EECA.
    `forces`: whether constraints exert forces."""
    items = private_joints.awake(list(space.constraints))  # writing the others would wake bodies
    own = [item for item in items if private_joints.law_of(item) is not None]
    with ExitStack() as within:
        kept = private_joints.motions({end for item in items for end in (item.a, item.b)})
        within.callback(restore_motions, kept)
        within.enter_context(silent(items))
        within.enter_context(with_laws(own, [lambda *_: 0.0] * len(own)))
        if not forces:
            within.callback(restore_max_forces, clear_max_forces(items))
        yield


def rest_step(
    space: pymunk.Space, dt: float, joints: JointRows | None = None, stored: bool = True, awake: Awake | None = None
) -> None:
    """Update pymunk's shapes by its own step, with all velocities 0, which moves nothing.

    It uses the real dt, so that `space.current_time_step` is right and a native step may be the next one: pymunk scales
    stored impulses by the ratio of its last two dt, but here velocities and all stored impulses are 0. All bodies must
    have velocity 0; jointed ones may end with velocities of round-off.

    Args:
        joints: the constraints of the space; their functions are not called, and they exert no forces.
        stored: whether pymunk may have impulses of joints from earlier steps, which it would apply too.
        awake: given where bodies sleep. Writing gravity or a joint would wake bodies: joints of sleeping bodies are not
            changed, and gravity acts; the caller overwrites the velocities.
    """
    asleep = awake is not None
    if joints is None:
        private_rest.rest(space, dt, asleep)
        return
    pushing, calling = joints.items if stored else joints.pushing(), joints.calling
    if awake is not None:
        pushing, calling = awake(pushing), awake(calling) if calling else calling
    outside = joints.partners.motions()
    if not (calling or joints.with_law):  # most spaces; an `ExitStack` would cost more
        max_forces = clear_max_forces(pushing)
        try:
            private_rest.rest(space, dt, asleep)
        finally:
            restore_max_forces(max_forces)
            restore_motions(outside)
        return
    own, laws = joints.with_law, joints.laws()
    if awake is not None:
        laws = [law for item, law in zip(own, laws, strict=True) if awake([item])]
        own = awake(own)
    with ExitStack() as within:
        within.callback(restore_motions, outside)
        if calling:
            within.enter_context(silent(calling))
        if own:
            within.enter_context(with_laws(own, laws))
        within.callback(restore_max_forces, clear_max_forces(pushing))
        private_rest.rest(space, dt, asleep)
