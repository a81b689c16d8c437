"""What a new scene takes over from the one before: results of earlier steps for bodies and shapes that are the same.

Bodies keep their islands, timers of rest and sides of thin shapes; pairs of shapes keep their contacts and forces. What
has come, gone or changed wakes what it touches:

* islands at rest that have lost a body or a contact, or touch another shape of one of their bodies, are CHANGED;
* a body with another shape counts as placed by the program;
* so do bodies that another shape of a body without mobility may overlap; their islands at rest are CHANGED.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import IntArray
from ..compiled import Table, kernel, nonallocating
from ..contacts.forces import key_of, row_for, table_has_room
from ..geometry.sides import keep_sides, shapes_of_pair
from ..islands.accounting import flag_pairs
from ..islands.at_rest import disturb
from ..model.contacts import LASTED
from ..model.scene import Scene, scene_of
from ..pairs.rules import may_collide
from .edits import FILTER, OUTLINE, SAME, Changes, change_words, disturb_changed, drop_sides, place_beside


class Kept(NamedTuple):
    """The bodies and shapes of a scene that the next one has too.

    Attributes:
        bodies: of each row of BODY the row in the next scene, -1 for a body that has gone.
        shapes: of each row of SHAPE the row in the next scene, -1 for one that has gone, has another outline or place
            on its body, or is of a static body that was moved.
        outlines: as shapes; also those of bodies that have fallen asleep or woken, and so are on the ground or were.
        changes: others, with rows of the next scene.
    """

    bodies: Sequence[int]
    shapes: Sequence[int]
    outlines: Sequence[int]
    changes: Changes

    def words(self) -> list[int]:
        """The numbers for `take_over`."""
        bodies, shapes, outlines, changes = self
        return [len(bodies), len(shapes), *bodies, *shapes, *outlines, *change_words(changes)]


def kept_in_place(n: int, k: int, changes: Changes) -> Kept:
    """Of n bodies and k shapes that have the same rows in the next scene, with these changes."""
    shapes = [*range(k)]
    for kind, row in changes:
        if kind == OUTLINE:
            shapes[row] = -1
    return Kept(range(n), shapes, shapes, changes)


@nonallocating
def take_bodies(P: Scene, A: Scene, BODIES: IntArray) -> None:
    """Take over what belongs to single bodies. The next events of all are to be predicted again."""
    for j in range(A.BODY.shape[0] - 1):
        A.BODY[j].due = -1.0
    for i in range(P.BODY.shape[0] - 1):
        j = BODIES[i]
        if j < 0:
            continue
        tied, next_tied = A.MEMBER[j].tied, A.MEMBER[j].next_tied
        A.MEMBER[j] = P.MEMBER[i]
        A.MEMBER[j].tied, A.MEMBER[j].next_tied = tied, next_tied
        A.RESTING[j] = P.RESTING[i]
        A.RESTING[j].rest_due = 0.0
        for c in range(3):
            A.BEGAN[j, c], A.PULL[j, c] = P.BEGAN[i, c], P.PULL[i, c]


@nonallocating
def take_islands(P: Scene, A: Scene, BODIES: IntArray) -> None:
    """Take over the islands, without the bodies that have gone. Those at rest that have lost some, or where joints hold
    or held a body, are CHANGED."""
    for i in range(P.BODY.shape[0] - 1):
        if P.STATE[i].island != i:
            continue
        root, last, bodies, changed = -1, -1, 0, False
        m = i
        while m >= 0:
            j = BODIES[m]
            changed = changed or j < 0 or P.MEMBER[m].tied >= 0 or A.MEMBER[j].tied >= 0
            if j >= 0:
                root = j if root < 0 else root
                if last >= 0:
                    A.MEMBER[last].following = j
                A.STATE[j].island, A.MEMBER[j].following = root, -1
                last, bodies = j, bodies + 1
            m = P.MEMBER[m].following
        if root < 0:
            continue
        first = P.MEMBER[i]
        A.MEMBER[root].last, A.MEMBER[root].bodies = last, bodies
        A.MEMBER[root].open, A.MEMBER[root].jointed, A.MEMBER[root].rest = first.open, first.jointed, first.rest
        A.MEMBER[root].unverified, A.MEMBER[root].with_supports = first.unverified, first.with_supports
        A.MEMBER[root].new_forces = first.new_forces
        if changed:
            disturb(A, root)


@nonallocating
def same_pair(SHAPES: IntArray, a: int, b: int) -> bool:
    """Whether both shapes a and b of the scene before are the same, in the same order."""
    return bool(SHAPES[a] >= 0 and SHAPES[b] >= 0 and (a < b) == (SHAPES[a] < SHAPES[b]))


@nonallocating
def take_contacts(P: Scene, A: Scene, BODIES: IntArray, SHAPES: IntArray) -> None:
    """Take over the contacts of intervals. Islands at rest that lose one are CHANGED."""
    for c in range(P.COUNT.pushes):
        before, to, root, first = P.PUSHED_BY[c], A.COUNT.pushes, P.PUSHED_BY[c].root, -1
        a, b = SHAPES[before.a], SHAPES[before.b]
        if root >= 0:
            first = BODIES[root]
            root = A.STATE[first].island if first >= 0 else LASTED
        if to < A.PUSHED.shape[0] and same_pair(SHAPES, before.a, before.b) and may_collide(A, a, b):
            A.PUSHED_BY[to].a, A.PUSHED_BY[to].b, A.PUSHED_BY[to].root = a, b, root
            A.PUSHED[to] = P.PUSHED[c]
            A.COUNT.pushes += 1
            continue
        if first >= 0:
            disturb(A, first)
        for s in (a, b):
            if s >= 0:
                disturb(A, A.LINK[s].owner)


@nonallocating
def take_forces(P: Scene, A: Scene, SHAPES: IntArray) -> None:
    """Take over the forces of the last step."""
    k = P.SHAPE.shape[0]
    for row in range(P.KEYS.shape[0]):
        if P.KEYS[row] < 0 or P.FORCES[row].stamp < P.PAR.stamp or not table_has_room(A, 1):
            continue
        a, b = shapes_of_pair(k, P.KEYS[row] >> 1)
        if same_pair(SHAPES, a, b):
            force, key = P.FORCES[row], key_of(A, SHAPES[a], SHAPES[b]) | P.KEYS[row] & 1
            A.FORCES[row_for(A.KEYS, A.COUNT, key)] = force


@kernel
def take_over(BEFORE: Table, PRESENT: Table, WORDS: IntArray) -> None:
    """Let a scene that has taken no step go on from the one before.

    Args:
        BEFORE, PRESENT: `table_of` the scenes; of bodies and shapes BEFORE has only the numbers.
        WORDS: the numbers of `Kept.words`, and others after them.
    """
    P, A = scene_of(BEFORE), scene_of(PRESENT)
    n, k = WORDS[0], WORDS[1]
    BODIES, SHAPES, OUTLINES = WORDS[2 : 2 + n], WORDS[2 + n : 2 + n + k], WORDS[2 + n + k : 2 + n + 2 * k]
    CHANGES = WORDS[2 + n + 2 * k :]
    A.PAR.stamp, A.PAR.last, A.PAR.rules, A.COUNT.quiet = P.PAR.stamp, P.PAR.last, P.PAR.rules, P.COUNT.quiet
    A.COUNT.any_placed = 2  # so that islands are built in the next step, even where no contact remains
    take_bodies(P, A, BODIES)
    take_islands(P, A, BODIES)
    take_contacts(P, A, BODIES, SHAPES)
    take_forces(P, A, SHAPES)
    STATUS = np.full(A.SHAPE.shape[0], OUTLINE)
    for s in range(k):
        if OUTLINES[s] >= 0:
            STATUS[OUTLINES[s]] = SAME if SHAPES[s] >= 0 else FILTER
    for c in range(CHANGES[0]):
        if CHANGES[1 + 2 * c] == FILTER:
            STATUS[CHANGES[2 + 2 * c]] = FILTER
    place_beside(A, STATUS)
    disturb_changed(A, CHANGES)
    flag_pairs(A)
    if A.SIDE.shape[0] > 0 and P.SIDE.shape[0] > 0:
        keep_sides(A, P.SIDE, OUTLINES)
        drop_sides(A, STATUS)
