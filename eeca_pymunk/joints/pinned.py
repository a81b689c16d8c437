"""Bodies that joints hold where they are, which count as bodies that nothing moves: those on straight chains between
fixed points (`straight`), and welded ones (`welds`)."""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows, rows
from ..model.bodies import Body
from ..model.joints import CENTRE, FREE, GEAR, PIN, PIVOT, SLIDE, Joint, Pinned
from ..model.shapes import Link, Shape
from .plan import find_turning, together
from .straight import hold_chains
from .welds import weld

NO_PINNED = rows(Pinned, 0)


@kernel
def may_hold(joint: Rows[Joint], still: IntArray, n: int) -> bool:
    """Whether two joints that may hold a body end at bodies n + i with still[i] > 0."""
    ends = 0
    for j in range(len(joint)):
        a, b = joint[j].body[0], joint[j].body[1]
        fixed = (a >= n and still[a - n] > 0) or (b >= n and still[b - n] > 0)
        if fixed and joint[j].bounded == 0 and joint[j].kind in (PIN, PIVOT, SLIDE, GEAR):
            ends += 1
    return ends >= 2


@kernel
def find_pinned(
    BODY: Rows[Body], PARTNER: Rows[Body], joint: Rows[Joint], STILL: IntArray, SHAPE: Rows[Shape], LINK: Rows[Link],
    pinned: IntArray, welds: IntArray,
) -> int:  # fmt: skip
    """Find the bodies that joints hold where they are.

    Args:
        BODY (n,), PARTNER (x,): at their present poses; the latter cannot be moved by joints.  joint (j,).
        STILL (x,): 1 for rows of PARTNER that never move.
        SHAPE, LINK: of the bodies; contacts do not turn those without friction.
        pinned (n + x,): out, FREE, WHOLLY, CENTRE for a body that is held at its centre of mass and spins on, or
            WELDED.
        welds (n + x, 3): out, see `weld`.

    Returns:
        the number of bodies that are pinned.
    """
    if not may_hold(joint, STILL, len(BODY)):
        return 0
    bodies = together(BODY, PARTNER)
    still, spins = np.zeros(len(bodies), np.int64), np.zeros(len(bodies), np.int64)
    spins[: len(BODY)] = 1
    for i in range(len(PARTNER)):
        still[len(BODY) + i] = 1 if STILL[i] > 0 else -1
    for s in range(len(LINK)):
        if SHAPE[s].friction > 0.0:
            spins[LINK[s].owner] = 0
    turns, cayley = np.zeros(len(bodies), np.int64), np.zeros(len(bodies), np.int64)
    find_turning(bodies, joint, len(joint), turns, cayley)
    for i in range(len(bodies)):
        pinned[i] = FREE
        spins[i] = spins[i] if turns[i] == 0 else 0
    return hold_chains(bodies, joint, still, spins, pinned) + weld(bodies, joint, still, pinned, welds)


def pinned_bodies(
    BODY: Rows[Body], PARTNER: Rows[Body], joint: Rows[Joint], still: IntArray, SHAPE: Rows[Shape], LINK: Rows[Link]
) -> Rows[Pinned]:  # fmt: skip
    """The bodies that joints hold, see `find_pinned`; BODY has their mobilities."""
    n = len(BODY) + len(PARTNER)
    kind: IntArray = np.zeros(n, np.int64)
    welds: IntArray = np.full((n, 3), -1, np.int64)
    if not find_pinned(BODY, PARTNER, joint, still, SHAPE, LINK, kind, welds):
        return NO_PINNED
    at = np.flatnonzero(kind)
    PINNED, one = rows(Pinned, len(at)), BODY[at]
    PINNED["body"], PINNED["kind"], PINNED["weld"] = at, kind[at], welds[at, :2]
    PINNED["link"] = welds[at, 2]
    for name in ("x", "y", "angle"):
        PINNED[name] = one[name]
    for name, inverse in (("mass", one["inv_mass"]), ("moment", one["inv_inertia"])):
        PINNED[name] = np.divide(1.0, inverse, out=np.zeros(len(at)), where=inverse > 0.0)  # 0 for infinite: unmoved
    return PINNED


@nonallocating
def put_pinned(PINNED: Rows[Pinned], BODY: Rows[Body]) -> float:
    """Put pinned bodies where they are, at rest but for the spin of those that are pinned at their centre; the kinetic
    energy that they lose, which joints take as they take that of any velocity that does not fit them."""
    lost = 0.0
    for k in range(len(PINNED)):
        pinned, body = PINNED[k], BODY[PINNED[k].body]
        lost += 0.5 * pinned.mass * (body.vx * body.vx + body.vy * body.vy)
        body.x, body.y, body.vx, body.vy, body.ax, body.ay, body.angular = pinned.x, pinned.y, 0.0, 0.0, 0.0, 0.0, 0.0
        if pinned.kind != CENTRE:
            lost += 0.5 * pinned.moment * body.spin * body.spin
            body.angle, body.spin = pinned.angle, 0.0
    return lost
