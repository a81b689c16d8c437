"""Which bodies of an island move together when one of them is pushed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..model.islands import Island
from ..model.joints import Joints
from ..model.parameters.joints import STRUT, STRUT_BETWEEN


class Groups(NamedTuple):
    """GROUP (k,): group of each body, -1 for bodies that impulses do not move. BODY (n,): bodies in the order of
    groups, those of group g at FIRST[g] : FIRST[g + 1]. COMPONENT (groups,): its component, -1 for a body without
    joints. JOINTED: all components. LEAST (groups,): error of the response of a group: a contact between two of its
    bodies is left out if joints leave it no more than this part of its free mobility."""

    GROUP: IntArray
    FIRST: IntArray
    BODY: IntArray
    COMPONENT: IntArray
    JOINTED: IntArray
    LEAST: FloatArray


@kernel
def find_groups(WHO: IntArray, IM: FloatArray, J: Joints, impact: bool) -> Groups:
    """Find the groups of bodies WHO (k,), rows of BODY. At an `impact` springs exert no impulse, and bodies that these
    alone connect are groups of their own."""
    k, LEAST = len(WHO), np.full(len(WHO), STRUT_BETWEEN)
    groups, jointed, NUMBERS = 0, 0, np.zeros(7 * k + 1, np.int64)  # one array: an allocation takes as long as a body
    GROUP, NEXT, COMPONENT = NUMBERS[:k], NUMBERS[k : 2 * k], NUMBERS[2 * k : 3 * k]
    BODY, JOINTED, OF = NUMBERS[3 * k : 4 * k], NUMBERS[4 * k : 5 * k], NUMBERS[5 * k : 6 * k]
    FIRST = NUMBERS[6 * k :]
    for q in range(k):
        s = J.OF[WHO[q]] if IM[q] > 0.0 else -1
        loose = impact and s >= 0 and J.COMPONENT[s].dual_size == 0  # no joint has rows: all are springs
        GROUP[q], OF[q] = -1, -1 if loose else s
    for q in range(k):
        if IM[q] == 0.0 or GROUP[q] >= 0:
            continue
        GROUP[q], COMPONENT[groups] = groups, OF[q]
        if OF[q] >= 0:
            JOINTED[jointed] = OF[q]
            LEAST[groups] = STRUT if J.COMPONENT[OF[q]].cycles > 0 else STRUT_BETWEEN
            jointed += 1
            for p in range(q + 1, k):
                if OF[p] == OF[q]:
                    GROUP[p] = groups
        groups += 1
    for q in range(k):
        if GROUP[q] >= 0:
            FIRST[GROUP[q] + 1] += 1
    for g in range(groups):
        FIRST[g + 1] += FIRST[g]
        NEXT[g] = FIRST[g]
    for q in range(k):
        if GROUP[q] >= 0:
            BODY[NEXT[GROUP[q]]] = q
            NEXT[GROUP[q]] += 1
    return Groups(GROUP, FIRST[: groups + 1], BODY, COMPONENT[:groups], JOINTED[:jointed], LEAST[:groups])


@nonallocating
def least_mobility(groups: Groups, a: int, b: int) -> float:
    """The error of the response (see `Groups`) for a contact of bodies a and b, as a part of its free mobility."""
    g = groups.GROUP[a]
    return float(groups.LEAST[g]) if g >= 0 and g == groups.GROUP[b] else STRUT_BETWEEN


@nonallocating
def is_free(isle: Island, groups: Groups, n: int, J: Joints) -> bool:
    """Whether an island of n bodies is free: it has neither a contact nor a joint with a body that impulses do not
    move."""
    for s in groups.JOINTED:
        for i in range(J.COMPONENT[s].first_body, J.COMPONENT[s].end_body):
            if J.JOINED[i].freedoms == 0:
                return False
    return len(isle.IM) == n
