"""Midstep: psi2 = 0, every impulse at the middle of the step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .time_of_impact import event_loop

if TYPE_CHECKING:
    from ..impacts.scene import EventLoop
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
        """The event loop of a world that was just read, which has no events."""
        return event_loop(world, 0, together=True)
