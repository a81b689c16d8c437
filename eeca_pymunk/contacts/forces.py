"""The memory of contact forces across steps: a hash table from keys to forces, with open addressing.

KEYS (c,) int64, -1 where free, c a power of 2; FORCES (c,): the forces. Rows of steps before the last do not count, and
are removed by `copy_recent` when the table fills. COUNT.remembered: rows in use.
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..geometry.sides import pair_of, shapes_of_pair
from ..model.contacts import Force, Row
from ..model.scene import Scene
from ..model.step import Count


@nonallocating
def key_of(A: Scene, a: int, b: int) -> int:
    """Key of the first contact of shapes a and b, in either order; that of the second is 1 more."""
    return pair_of(A, a, b) << 1


@inlined
def shapes_of(A: Scene, row: Row) -> tuple[int, int]:
    """The shapes of a row, from its key."""
    return shapes_of_pair(A.SHAPE.shape[0], row.key >> 1)


@nonallocating
def find(KEYS: IntArray, key: int) -> int:
    """Row of a key in KEYS (c,), or -1 - (the free row where it would be)."""
    mask = len(KEYS) - 1
    # A product with a large odd number scatters the pairs; the two contacts of a pair are next to each other.
    pair = key >> 1
    row = (((pair ^ (pair >> 20)) * 11400714819323 >> 6) & ~1 | key & 1) & mask
    while KEYS[row] != key:
        if KEYS[row] < 0:
            return -1 - row
        row = (row + 1) & mask
    return row


@nonallocating
def table_has_room(A: Scene, contacts: int) -> bool:
    """Whether the table has room for the forces of so many more contacts: it is to be half full at most."""
    return bool(2 * (A.COUNT.remembered + contacts) <= A.KEYS.shape[0])


@nonallocating
def row_for(KEYS: IntArray, COUNT: Count, key: int) -> int:
    """Row of a key in KEYS (c,), which gets one if it has none: there must be a free one then."""
    row = find(KEYS, key)
    if row < 0:
        row = -1 - row
        KEYS[row] = key
        COUNT.remembered += 1
    return row


@nonallocating
def remember_force(A: Scene, key: int, normal: float, tangential: float, load: float, length: float) -> None:
    """Write a contact's forces (mass length/time²) over an interval of this length."""
    force = A.FORCES[row_for(A.KEYS, A.COUNT, key)]
    force.normal, force.tangential, force.load = normal, tangential, load
    force.length, force.stamp = length, A.PAR.stamp


@nonallocating
def remember_loads(A: Scene, ROWS: Rows[Row], L: FloatArray, m: int, h: float) -> None:
    """Write the forces of the active ones of m contacts, from their impulses L (m, 2) over h, and their loads, without
    the part that stops an approach."""
    for i in range(m):
        if L[i, 0] > 0.0:
            stopped = max(max(ROWS[i].target, 0.0) - ROWS[i].un, 0.0) * ROWS[i].k_n
            load = max(L[i, 0] - stopped, 0.0)
            remember_force(A, ROWS[i].key, L[i, 0] / h, L[i, 1] / h, load / h, h)


@nonallocating
def copy_recent(
    KEYS: IntArray, FORCES: Rows[Force], COUNT: Count, KEYS_2: IntArray, FORCES_2: Rows[Force], stamp: float
) -> None:
    """Copy rows with a stamp >= `stamp` to empty tables KEYS_2, FORCES_2 (of any size), and count them in COUNT."""
    COUNT.remembered = 0
    KEYS_2[:] = -1
    for row in range(len(KEYS)):
        if KEYS[row] >= 0 and FORCES[row].stamp >= stamp:
            FORCES_2[row_for(KEYS_2, COUNT, KEYS[row])] = FORCES[row]
