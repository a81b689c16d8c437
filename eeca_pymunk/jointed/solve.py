"""The length of an interval of an island with joints: as long as `attempt.py` solves it and its motion allows."""

from __future__ import annotations

from ..compiled import kernel
from ..contacts.counts import spend
from ..islands import local
from ..islands.candidates import pairs_within
from ..islands.membership import lossy
from ..model.joints import Joints
from ..model.parameters.events import RESOLUTION
from ..model.parameters.intervals import INTERVAL_RETRY, INTERVAL_TRIES, UNSOLVED_PART
from ..model.parameters.joints import INTERVAL_WORK
from ..model.scene import Scene
from ..model.step import AGAIN, DONE, PUSHES_FULL, SPENT
from .alone import begin_alone, is_component, meets_no_other
from .attempt import gather_attempt, note_residual, solve_attempt, take_attempt
from .gathered import restore_joints
from .ledger import work_left
from .lengths import next_length, within_sagitta
from .rest import rest_if_still


@kernel
def begin_jointed(A: Scene, J: Joints, root: int, t: float, h: float) -> int:
    """Begin an interval of an island with joints at instant t, the instant of all its bodies: of length h, or shorter
    if joints do not hold, contacts are not solved, work is short, or bodies move too far (`lengths`).

    A length that was too long is not tried again at once: the next interval is at most INTERVAL_RETRY times as long as
    one that was shortened, and else as long as its motion allows, at most INTERVAL_GROWTH times (`Rest.longest`).

    Returns DONE; PUSHES_FULL, with everything as before; or SPENT if the step has no work left, with only
    `Rest.longest` set.
    """
    rest, longest = A.RESTING[root], h
    # One as short as PAR.instant would be empty (`ends.end_here`).
    least = min(h, 2.0 * A.PAR.instant)
    # How a step was cut does not tell how short the intervals of the next one have to be.
    tried = h = min(h, rest.longest if t > 0.0 else max(rest.longest, h / RESOLUTION**2))
    spent = work_left(A, J) < 0.0
    for attempt in range(INTERVAL_TRIES):
        h = max(h, least)
        last = attempt + 1 == INTERVAL_TRIES or A.COUNT.together > 0 or h <= least or (spent and attempt > 0)
        if t > 0.0 and spent:
            rest.longest = max(h, tried / UNSOLVED_PART)  # with which the next step begins
            return SPENT
        left = work_left(A, J)
        status, then = try_jointed(A, J, root, t, h, last)
        if status != AGAIN:
            if status == DONE:
                longer = max(then if attempt == 0 else INTERVAL_RETRY * h, 0.0 if h < longest else rest.longest)
                i = root
                while i >= 0:
                    A.RESTING[i].longest = longer
                    i = A.MEMBER[i].following
                if t == 0.0 and h == longest:
                    rest_if_still(A, J, root)
            return status
        # Whether there is no work for another attempt, which takes a part of this one's, as it is solved more easily.
        spent = UNSOLVED_PART * work_left(A, J) < left - work_left(A, J)
        tried, h = h, min(then, h / RESOLUTION) if spent else then
    return DONE  # not reached: the last attempt is never AGAIN


@kernel
def try_jointed(A: Scene, J: Joints, root: int, t: float, h: float, last: bool) -> tuple[int, float]:
    """`begin_jointed` for one length h. Returns DONE and the length that the next interval may have; or, with nothing
    done, PUSHES_FULL, or AGAIN and the length to try next, if h is too long and this is not the `last` attempt."""
    single, A.RESTING[root].excess_left = is_component(A, J, root), 0.0
    if single and meets_no_other(A, root):
        return begin_alone(A, J, root, t, h, last)
    MINE = local.number_bodies(A, root)
    # All pairs within the step, also if the interval is shorter: others would not be searched for impacts.
    found = pairs_within(A, root, t, A.PAR.planned - t, lossy(A, root), MINE)
    p = len(found)
    spend(A, len(MINE), 2 * p, 0.0)  # besides what joints take
    J.PROGRESS.effort += INTERVAL_WORK * (p + 2)
    if p == 0 and single:
        local.clear_places(A, MINE)
        return begin_alone(A, J, root, t, h, last)
    shorter = within_sagitta(A, found, t)
    if shorter < h and not last:
        local.clear_places(A, MINE)
        return AGAIN, shorter
    if local.lacks_rows(A, p):
        local.clear_places(A, MINE)
        return PUSHES_FULL, h
    tried = gather_attempt(A, J, MINE, found, t, h)
    solved, far = solve_attempt(A, J, tried, root, last)
    if far > INTERVAL_RETRY and not last:
        for s in tried.interval.groups.JOINTED:
            restore_joints(J, s)
        local.clear_places(A, MINE)
        return AGAIN, h / far
    note_residual(A, tried.interval, tried.contacts.L, solved, J.PROGRESS.tolerance)
    take_attempt(A, J, tried, root, MINE)
    return DONE, next_length(h, far if solved or not tried.interval.few else 1.0)
