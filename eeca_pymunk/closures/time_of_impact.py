"""TimeOfImpact: the closure that puts every impulse at its computed time of impact (paper, psi2 = 1 - 2 tau / dt)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..arguments import check_count
from ..impacts.scene import EventLoop
from ..joints.workspace import NO_LINKAGE

if TYPE_CHECKING:
    from ..space.world import World

_MOST = 2**31 - 1  # impacts, which compiled code counts as integers


@dataclass(frozen=True)
class TimeOfImpact:
    """psi2 = 1 - 2 tau / dt with tau the time of impact, and the normal there: exact for disks and flat walls.

    The step follows the paths of the bodies from impact to impact through one queue of events. Impacts of one body at
    one instant, up to round-off, and contacts that touch then are solved together. Exact up to round-off for elastic
    and inelastic impacts of disks with disks and walls under constant forces, at any dt; second order for persistent
    contacts on curved shapes.

    Args:
        max_impacts: of a body in a step, >= 0. Further ones are ignored, and `report.converged` is False.
    """

    max_impacts: int = 100_000

    def __post_init__(self) -> None:
        check_count("max_impacts", self.max_impacts, most=_MOST)

    def prepare(self, world: World) -> EventLoop:
        """The event loop of a world that was just read."""
        return event_loop(world, self.max_impacts)


def event_loop(world: World, limit: int, together: bool = False) -> EventLoop:
    """The event loop of a world, see `EventLoop`."""
    linkage = NO_LINKAGE if world.joints is None else world.joints.linkage
    return EventLoop(world.laid, limit, linkage, together, world.memory)
