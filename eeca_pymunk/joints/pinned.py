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
    PINNED: Rows[Pinned],
) -> int:  # fmt: skip
    """Find the bodies that joints hold where they are.

    Args:
        BODY (n,), PARTNER (x,): at their present poses; the latter cannot be moved by joints.  joint (j,).
        STILL (x,): 1 for rows of PARTNER that never move.
        SHAPE, LINK: of the bodies; contacts do not turn those without friction.
        PINNED (n,): out, in its first rows: the bodies that are held, in the order of BODY.

    Returns:
        the number of bodies that are held.
    """
    if not may_hold(joint, STILL, len(BODY)):
        return 0
    bodies = together(BODY, PARTNER)
    still, spins = np.zeros(len(bodies), np.int64), np.zeros(len(bodies), np.int64)
    spins[: len(BODY)] = 1
    for i in range(len(BODY)):
        still[i] = 0 if BODY[i].inv_mass > 0.0 else -1  # joints hold no body whose motion they cannot change
    for i in range(len(PARTNER)):
        still[len(BODY) + i] = 1 if STILL[i] > 0 else -1
    for s in range(len(LINK)):
        if SHAPE[s].friction > 0.0:
            spins[LINK[s].owner] = 0
    turns, cayley = np.zeros(len(bodies), np.int64), np.zeros(len(bodies), np.int64)
    find_turning(bodies, joint, len(joint), turns, cayley)
    kinds, welds = np.zeros(len(bodies), np.int64), np.full((len(bodies), 3), -1, np.int64)
    for i in range(len(bodies)):
        spins[i] = spins[i] if turns[i] == 0 else 0
    held = hold_chains(bodies, joint, still, spins, kinds) + weld(bodies, joint, still, kinds, welds)
    found = 0
    for i in range(len(BODY) if held > 0 else 0):
        if kinds[i] != FREE:
            one, body = PINNED[found], BODY[i]
            one.body, one.kind, one.weld[0], one.weld[1], one.link = i, kinds[i], welds[i, 0], welds[i, 1], welds[i, 2]
            one.x, one.y, one.angle = body.x, body.y, body.angle
            one.inv_mass, one.inv_inertia = body.inv_mass, body.inv_inertia
            found += 1
    return found


def pinned_bodies(
    BODY: Rows[Body], PARTNER: Rows[Body], joint: Rows[Joint], still: IntArray, SHAPE: Rows[Shape], LINK: Rows[Link]
) -> Rows[Pinned]:  # fmt: skip
    """The bodies that joints hold, see `find_pinned`; BODY has their mobilities."""
    found = rows(Pinned, len(BODY))
    return found[: find_pinned(BODY, PARTNER, joint, still, SHAPE, LINK, found)]


@kernel
def hold(PINNED: Rows[Pinned], BODY: Rows[Body], held: bool) -> None:
    """Let the bodies that joints hold have no mobilities, or, if not `held`, give these back."""
    for k in range(len(PINNED)):
        one, body = PINNED[k], BODY[PINNED[k].body]
        body.inv_mass, body.inv_inertia = (0.0, 0.0) if held else (one.inv_mass, one.inv_inertia)


@nonallocating
def mass_of(inverse: float) -> float:
    """Mass or moment by its inverse; 0 for an infinite one, which nothing moves."""
    return 1.0 / inverse if inverse > 0.0 else 0.0


@nonallocating
def put_pinned(PINNED: Rows[Pinned], BODY: Rows[Body]) -> float:
    """Put pinned bodies where they are, at rest but for the spin of those that are pinned at their centre; the kinetic
    energy that they lose, which joints take as they take that of any velocity that does not fit them."""
    lost = 0.0
    for k in range(len(PINNED)):
        pinned, body = PINNED[k], BODY[PINNED[k].body]
        lost += 0.5 * mass_of(pinned.inv_mass) * (body.vx * body.vx + body.vy * body.vy)
        body.x, body.y, body.vx, body.vy, body.ax, body.ay, body.angular = pinned.x, pinned.y, 0.0, 0.0, 0.0, 0.0, 0.0
        if pinned.kind != CENTRE:
            lost += 0.5 * mass_of(pinned.inv_inertia) * body.spin * body.spin
            body.angle, body.spin = pinned.angle, 0.0
    return lost
