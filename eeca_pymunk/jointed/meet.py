"""Islands with joints are brought to the instant at which they meet other shapes, on their own paths."""

from __future__ import annotations

import math

from ..compiled import kernel, nonallocating
from ..compiled.records import Rows, zeros
from ..geometry.gap import gap
from ..geometry.widths import smaller
from ..islands.membership import in_large_island, members_of
from ..islands.rest import speed
from ..model.islands import MEETING, Meeting
from ..model.joint_steps import UNHELD
from ..model.joints import Joints
from ..model.parameters.events import RESOLUTION
from ..model.parameters.intervals import TOUCH
from ..model.parameters.joints import (
    CLOSES,
    COLUMN_CONTACTS,
    END_HALVINGS,
    MEET,
    MEET_DEEP,
    MEET_DOUBLINGS,
    MEET_HALVINGS,
    MEET_LOADED,
    MEET_MANY,
    MEET_SECANTS,
    MEET_SECANTS_LOADED,
)
from ..model.scene import Scene
from .ends import carry, end_here, left_apart, shorten, under_way
from .ledger import work_left
from .paths import crossing_of_paths, gap_and_rate, instants_between, passes_through


@kernel
def valid_end(A: Scene, J: Joints, root: int, t: float) -> float:
    """The end of the interval of an island, shortened to instant t: its length is halved while joints do not hold at
    its end or it has passed through other shapes, at last to nothing, and at once if the work of the step is spent."""
    began, end = A.BODY[root].since, t
    for tries in range(END_HALVINGS):
        if not (left_apart(A, J, root) or passes_through(A, root, end) < math.inf):
            break
        J.TALLY.worst = UNHELD
        hopeless = tries + 1 == END_HALVINGS or work_left(A, J) < 0.0
        end = began if hopeless else 0.5 * (began + end)
        shorten(A, J, root, end)
    return end


@kernel
def wait_until(A: Scene, J: Joints, root: int, end: float, t: float) -> None:
    """End the interval of an island at its end. The island then stays there until instant t, or moves with its moving
    partners (`carry`)."""
    end_here(A, J, root, end)
    carry(A, J, root, t)
    for i in members_of(A, root):
        A.BODY[i].since = t


@kernel
def end_by(A: Scene, J: Joints, root: int, t: float) -> None:
    """End the interval of an island at instant t, or at a valid instant before t (`valid_end`), from where it waits
    until t."""
    shorten(A, J, root, t)
    wait_until(A, J, root, valid_end(A, J, root, t), t)


@kernel
def begin_meeting(A: Scene, J: Joints, a: int, b: int, t: float, SEARCH: Rows[Meeting]) -> None:
    """Write the record of the search for the impact of shapes a and b, predicted for t. Shapes that overlap at the
    start without closing meet when they are as deep again; those that touch there, and close by velocities that joints
    allow (`paths.gap_and_rate`), meet at once."""
    S, i, j = SEARCH[0], A.LINK[a].owner, A.LINK[b].owner
    S.a, S.b, S.t = a, b, t
    S.roots[0], S.roots[1] = A.STATE[i].island, A.STATE[j].island if A.BODY[j].inv_mass > 0.0 else -1
    S.least, S.latest = instants_between(A, i, j, (S.roots[0], S.roots[1]), t)
    S.small = smaller(A, a, b)
    S.start, rate = gap_and_rate(A, J, a, b, S.least, False)
    # Closing by round-off, as after an impact, does not count: an impact would not change it.
    slow = CLOSES * max(speed(A, i), speed(A, j))
    S.rate = 0.0 if abs(rate) <= slow else rate
    if S.rate >= 0.0 and S.start <= TOUCH * S.small:
        _, allowed = gap_and_rate(A, J, a, b, S.least, True)
        if allowed < -slow:
            S.rate, S.t = allowed, S.least
    S.level = min(S.start, 0.0) if S.rate >= 0.0 else 0.0
    S.apart = S.least


@kernel
def end_both(A: Scene, J: Joints, S: Meeting, t: float) -> None:
    """`shorten` both islands to t, or one if both are the same."""
    S.t, S.pressing = t, shorten(A, J, S.roots[0], t)
    if S.roots[1] != S.roots[0]:
        S.pressing += shorten(A, J, S.roots[1], t)


@nonallocating
def too_late(A: Scene, J: Joints, S: Meeting) -> float:
    """The instant by which one of both islands, whose intervals end at S.t, has moved too far: it `passes_through`
    another shape, or is `left_apart` at S.t; infinity if neither has."""
    if left_apart(A, J, S.roots[0]) or left_apart(A, J, S.roots[1]):
        return S.t
    return min(passes_through(A, S.roots[0], S.t), passes_through(A, S.roots[1], S.t))


@kernel
def find_contact(A: Scene, J: Joints, S: Meeting) -> None:
    """Search the instant at which the gap is S.level by secants on the gap at the end of shortened intervals. It is no
    continuous function of their length: stiff springs swing more than once in a coarse interval. If shapes are on the
    far side of each other, or their paths cross before the end, the instant is halved towards S.apart.

    It ends where shapes touch; once the work of the step is spent; after MEET_SECANTS instants, of which fewer are
    tried where contacts push and the shapes are not deep in each other; where the gap does not close; and where no
    other instant is left."""
    most, before, gap_before = 1 if in_large_island(A, S.a, S.b) else MEET_SECANTS_LOADED, -1.0, 0.0
    crosses = False
    for tries in range(MEET_SECANTS):
        t, last = S.t, tries + 1 == MEET_SECANTS
        end_both(A, J, S, t)
        S.gap, spent = gap(A, S.a, S.b, t)[0] - S.level, J.PROGRESS.effort > J.PROGRESS.budget
        S.touch = S.small * (MEET if S.pressing == 0 else MEET_LOADED if S.pressing <= COLUMN_CONTACTS else MEET_MANY)
        crosses, through = False, t
        if S.gap + S.level > S.touch:
            through, crosses = crossing_of_paths(A, S.a, S.b, t)
        # Depths add up from impact to impact.
        deep = not spent and S.gap < -MEET_DEEP * S.small
        if (S.pressing > 0 and tries + 1 >= most and not deep) or spent or abs(S.gap) <= S.touch:
            break
        secant = before >= 0.0 and t != before
        slope = (S.gap - gap_before) / (t - before) if secant else gap_and_rate(A, J, S.a, S.b, t, False)[1]
        if not slope < 0.0 and S.gap < -S.touch and S.start >= -S.touch:
            # Beyond the middle of a thin shape the normal is that of its far side.
            through, crosses = crossing_of_paths(A, S.a, S.b, t)[0], True
        if crosses:
            if last:
                break
            S.crossed, before = 1, -1.0
            S.t = through if S.apart < through < t else 0.5 * (S.apart + t)
            continue
        if S.gap > 0.0 and not (left_apart(A, J, S.roots[0]) or left_apart(A, J, S.roots[1])):
            S.apart = t
        if not slope < 0.0 or last:  # the last attempt stays
            break
        before, gap_before = t, S.gap
        then = max(min(t - S.gap / slope, S.latest), S.least)
        # A flat secant leads back to the start, where shapes that were apart do not meet.
        away = S.level < 0.0 or S.start > S.touch
        if (then == S.least and away) or (then <= S.apart and S.pressing > 0 and deep):
            then = 0.5 * (S.apart + t)
        if then == t:
            break
        S.t = then
    # Joints may bring the shapes together before the first secant.
    S.crosses = int(crosses or (S.pressing == 0 and S.rate >= 0.0 and S.gap < -MEET_DEEP * S.small))


@kernel
def find_apart_before(A: Scene, J: Joints, S: Meeting) -> bool:
    """Halve the instant towards S.apart while paths cross before it or it is `too_late`, and towards the start if it is
    so near S.apart that this is too late, too; once the work of the step is spent, it is S.apart. Returns whether it is
    known to be neither."""
    for _ in range(MEET_HALVINGS):
        late = math.inf if S.crosses > 0 else too_late(A, J, S)
        if not (S.crosses > 0 or late < math.inf):
            return True
        if late <= S.apart or (S.crosses == 0 and RESOLUTION * (S.t - S.apart) <= S.t - S.least):
            S.apart = S.least  # where the shapes are apart, something is too far already
        spent = work_left(A, J) < 0.0
        S.crossed = 1
        end_both(A, J, S, S.apart if spent else 0.5 * (S.apart + S.t))
        S.gap = gap(A, S.a, S.b, S.t)[0] - S.level
        # Where a limit drives them together, the instant after it counts: before it they are as at the start.
        through = S.gap + S.level > S.touch and crossing_of_paths(A, S.a, S.b, S.t)[1]
        S.crosses = int(S.gap < -TOUCH * S.small or through)
        if spent:
            break
    return False


@kernel
def find_later(A: Scene, J: Joints, S: Meeting) -> bool:
    """An instant after the start for shapes that only close once joints act, for instance at a limit that directs
    velocities into the other shape. The interval doubles with each impact of the bodies, so that the step ends, and is
    halved while it is `too_late`. Returns whether it is not."""
    i, j = A.LINK[S.a].owner, A.LINK[S.b].owner
    met = min(max(A.STATE[i].impacts, A.STATE[j].impacts), MEET_DOUBLINGS)
    end_both(A, J, S, min(S.least + 2.0 ** (met + 1) * A.PAR.instant, S.latest))
    valid = too_late(A, J, S) == math.inf
    while not valid and S.t - S.least > A.PAR.instant and work_left(A, J) >= 0.0:
        end_both(A, J, S, 0.5 * (S.least + S.t))
        valid = too_late(A, J, S) == math.inf
    return valid


@kernel
def end_meeting(A: Scene, J: Joints, SEARCH: Rows[Meeting], valid: bool) -> tuple[float, bool]:
    """End the intervals of both islands at the instant found, or at a valid instant before it unless that is known to
    be (`valid`). Returns the instant, and whether the shapes are apart there: shapes that close within PAR.instant,
    which is no interval, meet now."""
    S = SEARCH[0]
    g, crossed = S.gap, S.crossed > 0
    for side in range(2):
        root = S.roots[side]
        if not under_way(A, root):
            continue
        spent = work_left(A, J) < 0.0  # then the step ends where the island does
        end = S.t if valid else valid_end(A, J, root, S.t)
        wait_until(A, J, root, end, end if spent else S.t)
        if end < S.t:
            g, crossed = math.inf if work_left(A, J) < 0.0 else gap(A, S.a, S.b, S.t)[0] - S.level, True
    return S.t, crossed and g > max(S.touch, -S.rate * A.PAR.instant)


@kernel
def locate_impact(A: Scene, J: Joints, a: int, b: int, t: float) -> tuple[float, bool]:
    """Bring the islands of shapes a and b, predicted to meet at instant t, to the instant at which they do. Returns it,
    and whether the shapes are apart there.

    An interval that ends earlier has another path, so the instant is searched, in turn by

    | search | where | instants | until |
    |---|---|---|---|
    | `find_contact` | always | by secants on the gap, MEET_SECANTS, fewer where contacts push | shapes touch |
    | `find_apart_before` | no interval ends so | halved, MEET_HALVINGS, to where they are apart | valid |
    | `find_later` | that is the start | after it, later with each impact, halved | valid |
    | `valid_end` | not known to be valid | of each island by itself: halved, END_HALVINGS, then the start | valid |

    where an instant is valid if it is not `too_late`. An island for which none is stays where it is until then.
    """
    i, j = A.LINK[a].owner, A.LINK[b].owner
    if not (under_way(A, A.STATE[i].island) or (A.BODY[j].inv_mass > 0.0 and under_way(A, A.STATE[j].island))):
        # Both are at t, and have no paths beyond it: only bodies that they touch have joints.
        return t, False
    SEARCH = zeros(1, MEETING)
    begin_meeting(A, J, a, b, t, SEARCH)
    S = SEARCH[0]
    find_contact(A, J, S)
    valid = find_apart_before(A, J, S)
    if S.rate >= 0.0 and S.t - S.least <= A.PAR.instant:
        valid = find_later(A, J, S)
    return end_meeting(A, J, SEARCH, valid)  # the array itself: S is only valid as long as it is used
