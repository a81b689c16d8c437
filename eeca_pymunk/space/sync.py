"""Sync: pymunk's own shapes and broad phase where a step has put the bodies, for its queries and drawing.

Two ways. A *rest step*, pymunk's own step with everything at rest, moves nothing, renews the broad phase and arbiters,
forgets old contacts, and notes dt. *Reindexing* moves the shapes of one body after the other; it costs less for a few
bodies, above all where they touch or hang from joints, and leaves all the rest as it is. In a spatial hash it leaves
handles behind, which the next rest step clears, so there is one every so many steps. Post-step callbacks come after
either, when bodies have their velocities.

Who asks for arbiters after a step that has reindexed gets a rest step then (`Sync.renew`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING

import pymunk

from ..reentry import BUSY
from . import private, private_joints, private_rest
from .bodies import ANGULAR_VELOCITY, VELOCITY, Bodies
from .joints import JointRows
from .private_joints import inert, silent, strengthen, weaken, with_laws

if TYPE_CHECKING:
    from .world import World

# Moving shapes up to which reindexing costs less than a rest step: where nothing touches, up to 25 in a tree and 10 in
# a hash; with contacts any number in a tree, and 15 in a hash; with joints 50 and 30.
FEW, SOME = 12, 32
_RENEW = 32  # steps after which reindexing gives way to a rest step


Choice = Callable[[Sequence[pymunk.Constraint]], list[pymunk.Constraint]]


def rest_step(
    space: pymunk.Space, dt: float, joints: JointRows | None = None, forget: bool = True, awake: Choice | None = None
) -> None:
    """Let pymunk see the new positions: its own step with everything at rest moves nothing.

    With the real dt, so that `space.current_time_step` is right and a native step may follow: at rest pymunk
    caches no impulse that it would scale by the ratio of the two steps. All bodies must have velocity 0; those of
    joints may end with another, of round-off.

    Args:
        joints: the constraints of the space, which call no functions meanwhile, and push with nothing where they would.
        forget: whether pymunk remembers impulses of joints, which would push too.
        awake: where bodies sleep, which of constraints have no such body. A change of gravity would wake them: it
            stays, and leaves velocities, which are of no use.
    """
    asleep = awake is not None
    if joints is None:
        private_rest.rest(space, dt, asleep)
        return
    push, calling = joints.items if forget else joints.pushing(), joints.calling
    if awake is not None:  # pymunk has put their joints away, and any change of one would wake its bodies
        push, calling = awake(push), awake(calling)
    if not (calling or joints.own or joints.partners.outside):
        held = weaken(push)
        try:
            private_rest.rest(space, dt, asleep)
        finally:
            strengthen(held)
        return
    own, laws = joints.own, joints.laws()
    if awake is not None:
        laws = [law for item, law in zip(own, laws, strict=True) if awake([item])]
        own = awake(own)
    with ExitStack() as within:
        if joints.partners.outside:
            within.enter_context(joints.partners.kept())
        if calling:
            within.enter_context(silent(calling))
        if own:
            within.enter_context(with_laws(own, laws))
        if push:
            within.enter_context(inert(push))
        private_rest.rest(space, dt, asleep)


class Sync:
    """Which of the two ways a step takes.

    Attributes:
        late: whether those who ask for arbiters call `renew`.
    """

    def __init__(self, world: World, past: Sync | None = None) -> None:
        """`past`: that of the world of this space before; pymunk itself puts what has come since into its index."""
        self.space, bodies = world.space, world.bodies
        self._asleep = bool(bodies.asleep.any())
        self._called = len(bodies.velocity_hooks) + len(bodies.position_hooks) > 0
        self._shapes = sum(bodies.shapes.values())
        self._pointers = bodies.moving
        self._timestamp: Callable[[], int] = private.timestamp(self.space)
        self._renewed, self._dt, self._left = -1, 0.0, 0
        self._touched = self._stale = self._asked = False
        if past is not None and not (self._asleep or past._asleep):
            self._renewed, self._dt, self._left = past._renewed, past._dt, past._left
            self._touched, self._stale, self._asked = past._touched, past._stale, past._asked
        self._joints = world.joints
        self._new = True  # bodies and joints may have come from elsewhere, with what pymunk has left in them
        self.late = False
        self.stamp = -1  # pymunk's count of steps after our last one, -1 before the first

    def reindexes(self, dt: float, contacts: bool, joints: JointRows | None) -> bool:
        """Whether reindexing does for this step: it costs less, pymunk took no step since our last rest step, which
        knows this dt, and nothing touched in either, so that `each_arbiter` has nothing to tell, or it asks later,
        which it did not do after the step before."""
        asked, self._asked = self._asked, False
        if asked or self._left == 0 or dt != self._dt or self._shapes > SOME:
            return False
        if contacts or self._touched:
            if not self.late:
                return False
        elif self._shapes > FEW and joints is None:
            return False
        self._joints = joints
        return self._timestamp() == self._renewed

    def reindex(self) -> None:
        """Move the shapes to where their bodies are."""
        self._left -= 1
        self._stale = True
        private.reindex(self.space, self._pointers)

    def renew(self) -> None:
        """Have arbiters as a rest step makes them, if the last step was ours and made none."""
        self._asked = True
        if self._stale and self.space not in BUSY and self._timestamp() == self._renewed:
            with private_rest.stopped(self.space):
                self.rest(self._dt, self._joints)

    def waits(self) -> bool:
        """Whether post-step callbacks wait for the end of a step."""
        return private.waits(self.space)

    def call_back(self) -> None:
        """Do what waits for the end of a step: post-step callbacks."""
        if self.waits():
            private.finish_step(self.space)

    def note(self) -> None:
        """The steps that pymunk has taken until now were ours."""
        self.stamp = self._timestamp()

    def is_ours(self) -> bool:
        """Whether pymunk has taken no step of its own since our last one."""
        return self._timestamp() == self.stamp

    def rest(self, dt: float, joints: JointRows | None = None) -> None:
        """A rest step; all bodies must have velocity 0, and may have another of round-off if there are joints."""
        native = self._new or self._timestamp() != self._renewed
        self._new = False
        if native:
            private.forget_corrections(self._pointers)
        rest_step(self.space, dt, joints, native, self._choice(joints) if self._asleep else None)
        self._renewed, self._dt, self._left = self._timestamp(), dt, _RENEW
        self.stamp = self._renewed
        self._stale = False
        if not self.late and self._shapes <= FEW:
            self._touched = bool(private.raw_arbiters(self.space))

    def _choice(self, joints: JointRows | None) -> Choice:
        """Which of constraints have no body that sleeps: who sleeps at the start of a step does so at its end, unless
        functions have woken it."""
        if joints is None or self._called or joints.calling or joints.own:
            return private_joints.awake
        return joints.awake

    def land(self, world: World, dt: float, status: int) -> None:
        """Write the end of the step of a world with a rest step at it."""
        if world.joints is not None or self._asleep:
            status = world.turning(status)  # joints leave round-off in spins, gravity more
        world.scatter_still(status)
        self.rest(dt, world.joints)
        world.scatter_speed(status)

    def settle(self, bodies: Bodies, joints: JointRows, dt: float, contacts: bool) -> None:
        """Let pymunk see the end of a step that has been written already, which functions may have changed since."""
        if self.reindexes(dt, contacts, joints):
            self.reindex()
            return
        end = bodies.gather()
        assert end is not None  # what functions add and remove is still waiting
        still = end.copy()
        still[:, VELOCITY], still[:, ANGULAR_VELOCITY] = 0.0, 0.0
        bodies.scatter(still, unchanged=True)
        self.rest(dt, joints)
        bodies.scatter(end, unchanged=True)
