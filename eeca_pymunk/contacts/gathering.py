"""Contact rows of an island from the geometry of its pairs, for an interval h from now.

Normals and arms are those at the predicted middle q + (h/2) v, gaps those now: with u = G(middle) v the gap at the end
is g + (h/2)(u- + u+) to third order in h, so that bodies follow curved surfaces to second order without a loss; and an
island without forces keeps its angular momentum exactly, as its middle and the predicted one differ by multiples of the
impulses.

A pair has the geometry now instead if it moves too far in half an interval (an impact at high speed), hardly moves, or
has another number of contact points at the middle. How far it moves is measured in the frame of a wall that turns
(`turning_walls.py`) if it has one. Arms are then those now too. In a free island they must be those at the middle, for
its angular momentum: there the points of the pair are displaced by the mean of the displacements of its two bodies.
So has a pair that closes within the interval and passes a corner (`..pairs.passing`).
"""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows, empty
from ..geometry.flight import opening_rate_at
from ..geometry.manifold import manifold
from ..geometry.sides import note_side
from ..geometry.widths import smaller
from ..model.contacts import CONTACT_POINT, ContactPoint
from ..model.islands import Island, IslandContacts
from ..model.parameters.intervals import (
    INTERVAL_DEPTH_LEAST,
    INTERVAL_WAY,
    MANIFOLD_ROUND_OFF,
    MIDPOINT_SAME,
    TRAVEL_MARGIN,
)
from ..model.scene import Scene
from ..pairs.passing import pass_corner
from ..pairs.rules import law
from ..rows.build import place_row
from .forces import key_of
from .turning_walls import follow_rotation, spin_of_wall, way_about


@nonallocating
def may_pass(isle: Island, a: int, b: int, POINTS: Rows[ContactPoint], count: int, h: float, deep: float) -> bool:
    """Whether the contact of local bodies a and b may close in an interval h, by present velocities and by
    accelerations without contacts, and is no face wider than `deep`."""
    one, other, ACC = POINTS[0], POINTS[1], isle.ACC
    if count == 2 and max(one.gap, other.gap) <= deep:
        if (one.px - other.px) ** 2 + (one.py - other.py) ** 2 > deep * deep:
            return False
    if count == 2 and other.gap < one.gap:
        one = other
    u = opening_rate_at(isle.POSE, isle.V, a, b, one.nx, one.ny, one.px, one.py)
    pulled = one.nx * (ACC[b, 0] - ACC[a, 0]) + one.ny * (ACC[b, 1] - ACC[a, 1])
    return bool(one.gap + TRAVEL_MARGIN * (u + min(pulled, 0.0) * h) * h <= deep)


@kernel
def gather_contacts(A: Scene, isle: Island, contacts: IslandContacts, REACH: FloatArray, h: float, free: bool) -> int:
    """Write the ROWS of all contacts of an island's pairs whose gap is at most the sum of both bodies' REACH.

    Args:
        h: length of the interval.  isle, contacts: the island, and its contacts, out.
        REACH: (k,) length.  free: whether impulses move all k bodies.

    Returns:
        The number of rows, two at most for each pair.
    """
    SHAPE, LINK = A.SHAPE, A.LINK
    POSE, PAIRS, ROWS = isle.POSE, isle.PAIRS, contacts.ROWS
    NOW, THEN = empty(2, CONTACT_POINT), empty(2, CONTACT_POINT)
    m, half, MIDDLE = 0, 0.5 * h, isle.POSE + 0.5 * h * isle.V
    for c in range(len(PAIRS)):
        s, r, a, b = PAIRS[c, 0], PAIRS[c, 1], PAIRS[c, 2], PAIRS[c, 3]
        small = smaller(A, s, r)
        reach = REACH[a] + REACH[b]
        count = manifold(A, s, r, POSE, a, b, reach, MANIFOLD_ROUND_OFF * small, NOW)
        if count == 0:
            continue
        note_side(A, s, r, NOW[0].nx, NOW[0].ny, True)
        # How far points of both bodies move against each other in h/2; about: in the frame of a wall that turns.
        way = half * way_about(isle, a, b, 0.0)
        w = spin_of_wall(isle, a, b)
        about = half * way_about(isle, a, b, w) if w != 0.0 else way
        centre = MIDDLE
        # Normals rotate as circles move around each other, slowly around a large one.
        far = SHAPE[s].rounding + SHAPE[r].rounding if LINK[s].vertices == 1 and LINK[r].vertices == 1 else small
        since, deep = max(A.BODY[isle.WHO[a]].since, A.BODY[isle.WHO[b]].since), INTERVAL_DEPTH_LEAST * small
        passes = may_pass(isle, a, b, NOW, count, h, deep) and pass_corner(A, s, r, since, NOW[0])
        count = 1 if passes else count
        # ahead: normal and point are those of the middle.
        ahead = not passes and MIDPOINT_SAME * small < way and about <= 0.5 * INTERVAL_WAY * far
        if ahead:
            again = manifold(A, s, r, MIDDLE, a, b, reach + about, MANIFOLD_ROUND_OFF * small, THEN)
            ahead = again == count
        if not ahead:
            x, y = 0.0, 0.0
            if not free:
                centre = POSE
            else:
                # The same point for both bodies, relative to their middles, adds no angular momentum.
                x = 0.5 * (MIDDLE[a, 0] - POSE[a, 0] + MIDDLE[b, 0] - POSE[b, 0])
                y = 0.5 * (MIDDLE[a, 1] - POSE[a, 1] + MIDDLE[b, 1] - POSE[b, 1])
            for z in range(count):
                THEN[z] = NOW[z]
                THEN[z].px += x
                THEN[z].py += y
        elasticity, friction, sx, sy = law(A, s, r)
        for z in range(count):
            i = m + z
            row = ROWS[i]
            row.a, row.b, row.key = a, b, key_of(A, s, r) + z
            row.nx, row.ny, row.gap = THEN[z].nx, THEN[z].ny, NOW[z].gap
            row.elasticity, row.friction, row.surface = elasticity, friction, 0.0
            place_row(row, THEN[z].px, THEN[z].py, centre, isle.IM, isle.II)
            row.surface = row.nx * sy - row.ny * sx
        if ahead and w != 0.0:
            edge = LINK[s if isle.IM[a] == 0.0 else r].vertices > 1
            follow_rotation(isle, ROWS, m, count, NOW, w, h if edge else 0.0)
        m += count
    return m
