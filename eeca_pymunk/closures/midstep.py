"""Midstep: psi2 = 0, every impulse at the middle of the step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..impacts.scene import EventLoop

if TYPE_CHECKING:
    from ..space.world import World


@dataclass(frozen=True)
class Midstep:
    """The rigid limit K, xi -> infinity: psi2 = 0, impulses at the middle of the step.

    One bounded solve of all contacts of the step at once, of every shape, with friction and loss:

        v_np1 = v_n + dt a + M^-1 (G^T lam + T^T beta),   q_np1 = q_n + dt (v_n + v_np1) / 2,
        0 <= lam _|_ u_np1 - b >= 0,   b the targets of docs/method.md, section 4,

    with Coulomb's law for beta. Exact in energy and momenta; second order in free flight, first order in the place of
    impacts. psi1 is reported as infinite, its limit.
    """

    def prepare(self, world: World) -> EventLoop:
        """The arrays of the solve for a world that was read anew."""
        joint = None if world.joints is None else world.joints.joint
        return EventLoop(
            world.BODY, world.SHAPE, world.LINK, world.VERTEX, world.disks, 0, joint, world.PARTNER, together=True,
            still=world.still, memory=world.memory,
        )  # fmt: skip
