"""The end of an island's interval: the works of its contacts up to there enter the ledger. They are exact, as forces
are constant and velocities linear:

    change of energy = work of forces + external work + cost of the correction - restitution - friction,

of kinetic energy, and of potential energy as far as the penetration correction changes it. The forces are those that
cause the accelerations; both losses are >= 0; the correction costs at most these, and less than 0 if bodies sink by it.

If an interval is cut, its forces up to there may have given energy: then they are replaced (`shortened.py`). They may
also have changed the angular momentum, since the arms are those of the middle of the whole interval.
"""

from __future__ import annotations

from ..compiled import Table, nonallocating
from ..geometry.flight import move_to, norm
from ..geometry.gap import gap
from ..geometry.sides import note_side, remembers
from ..model.bodies import AT_REST, CHANGED
from ..model.contacts import ENDED, LASTED
from ..model.scene import Scene, scene_of
from ..pairs.rules import far_apart, mark_pair
from ..rows.energy import offset_gain
from .at_rest import log_contact, set_awake, wake_supported
from .loads import presses_on, renew_loads
from .local import contact_range
from .membership import unite
from .shortened import losses_up_to, repay
from .turned import keep_angular_momentum, report_lift


@nonallocating
def flag_pairs(TABLE: Table) -> None:
    """Set the flags in the near lists of the pairs that are contacts of intervals, so that they are not predicted.
    TABLE: `table_of` a Scene."""
    A = scene_of(TABLE)
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root >= 0:
            mark_pair(A, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, 1)


@nonallocating
def account_contact(A: Scene, c: int, t: float) -> None:
    """Enter the losses of contact c of an interval up to instant t in the ledger, log its impulse, and end it."""
    PAR, pushed = A.PAR, A.PUSHED[c]
    root, a, b = A.PUSHED_BY[c].root, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b
    A.PUSHED_BY[c].root = LASTED if t == PAR.dt else ENDED
    mark_pair(A, a, b, 0)
    f = (t - pushed.start) / pushed.length
    if f == 0.0 or (pushed.normal == 0.0 and pushed.tangential == 0.0):
        return
    normal, tangential = losses_up_to(A, c, t)
    A.RESTING[root].lost += normal + tangential
    normal, tangential = offset_gain(normal, tangential)
    PAR.restitution += normal
    PAR.frictional += tangential
    PAR.external += f * (pushed.work_unaccelerated + f * (pushed.work - pushed.work_unaccelerated))
    log_contact(A, c, f, f * pushed.length)


@nonallocating
def wake(A: Scene, root: int, t: float) -> int:
    """End the rest of an island at instant t, and that of the islands that it supports, directly or through others: the
    intervals of all end at t, and from then on they are one island. Their forces are those of their loads up to t.
    Returns its root."""
    MEMBER, one = A.MEMBER, root
    if t > 0.0 and A.COUNT.may_support > 0:
        # The forces of what rests on it, whose intervals end here, too, are final before they are its loads.
        last = -1  # contacts of an island are next to each other, and each is looked at once
        for c in range(A.COUNT.pushes):
            other = A.PUSHED_BY[c].root
            if other >= 0 and other != last and MEMBER[other].rest != AT_REST and presses_on(A, c, root):
                repay(A, other, t)
                last = other
        renew_loads(A, t)
    MEMBER[root].rest = CHANGED
    wake_supported(A)
    # Before others are united with it, which may become the root.
    set_awake(A, root)
    end_interval(A, root, t)
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i].island == i and A.BODY[i].inv_mass > 0.0 and MEMBER[i].rest == CHANGED:
            set_awake(A, i)
            end_interval(A, i, t)
            one = unite(A, one, i)
    return one


@nonallocating
def end_rest_or_interval(A: Scene, root: int, t: float) -> None:
    """End the interval of an island at instant t; of an island at rest also those of the islands that it supports."""
    if A.MEMBER[root].rest == AT_REST:
        wake(A, root, t)
    else:
        end_interval(A, root, t)


@nonallocating
def end_interval(A: Scene, root: int, t: float) -> None:
    """End the interval of one island without joints at instant t: replace forces that gave energy (`repay`), account
    its contacts, move its bodies to their poses at t, and keep the angular momentum of bodies in flight. Corrections
    are not made here: `lift_within_step` and `apply_correction` do where the interval ended as planned."""
    repay(A, root, t)
    first, end = contact_range(A, root)
    for c in range(first, end):
        account_contact(A, c, t)
    A.MEMBER[root].open = 0
    i = root
    while i >= 0:
        move_to(A.BODY, i, t)
        i = A.MEMBER[i].following
    keep_angular_momentum(A, root, first, end, t)


@nonallocating
def move_to_end(A: Scene, i: int, end: float) -> None:
    """Move body i of an island with joints to the end of its interval, and apply its correction, which the ledger of
    joints accounts (`..jointed.ledger`)."""
    move_to(A.BODY, i, end)
    body, rest = A.BODY[i], A.RESTING[i]
    body.x += rest.lift_x
    body.y += rest.lift_y
    body.angle += rest.lift_angle
    body.vx, body.vy, body.spin = rest.end_vx, rest.end_vy, rest.end_spin
    rest.lift_x, rest.lift_y, rest.lift_angle = 0.0, 0.0, 0.0


@nonallocating
def lift_way(A: Scene, i: int) -> float:
    """Length by which points of body i move at most by the correction at the end of its interval."""
    rest = A.RESTING[i]
    return norm(rest.lift_x, rest.lift_y) + abs(rest.lift_angle) * A.BODY[i].extent if A.STATE[i].island >= 0 else 0.0


@nonallocating
def hold_sides(A: Scene, i: int, end: float) -> None:
    """Note the sides of thin shapes of body i that its correction may move into others, so that they stay there. The
    contacts of the interval do not have all of these pairs, and no impact is predicted on a displacement."""
    own = lift_way(A, i)
    for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes if own > 0.0 else 0):
        for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number if A.CORNER[4 * s].thin > 0 else 0):
            o = int(A.POOL[w])
            reach = own + lift_way(A, A.LINK[o].owner)
            if not remembers(A, s, o) or far_apart(A, s, o, end, reach):
                continue
            g, nx, ny, _, _ = gap(A, s, o, end)
            if g <= reach:
                note_side(A, s, o, nx, ny, True)


@nonallocating
def apply_correction(A: Scene, root: int, end: float) -> None:
    """Apply the penetration correction of an island's bodies, displacements D, dtheta and changes of velocity, at the
    end of its interval. It costs the change of kinetic energy, less the work of forces m a.D + I alpha dtheta. Up to
    `Rest.payable` the cost is deducted from the losses of the step; beyond it is external work.
    Bodies of an island with joints are only moved to the end."""
    PAR, BODY, PULL, RESTING = A.PAR, A.BODY, A.PULL, A.RESTING
    spent = 0.0
    i = root
    if A.MEMBER[root].jointed > 0:
        while i >= 0:
            if A.MEMBER[root].open > 0 and A.MEMBER[root].rest != AT_REST:
                move_to_end(A, i, end)
            i = A.MEMBER[i].following
        return
    turned = False
    while i >= 0:
        move_to(BODY, i, end)
        turned = turned or RESTING[i].lift_vx != 0.0 or RESTING[i].lift_vy != 0.0
        linear = PULL[i, 0] * RESTING[i].lift_x + PULL[i, 1] * RESTING[i].lift_y
        linear -= RESTING[i].lift_vx * (BODY[i].vx + 0.5 * RESTING[i].lift_vx)
        linear -= RESTING[i].lift_vy * (BODY[i].vy + 0.5 * RESTING[i].lift_vy)
        spent -= linear / BODY[i].inv_mass
        if BODY[i].inv_inertia > 0.0:
            turning = RESTING[i].lift_spin * (BODY[i].spin + 0.5 * RESTING[i].lift_spin)
            spent += (turning - PULL[i, 2] * RESTING[i].lift_angle) / BODY[i].inv_inertia
        BODY[i].x += RESTING[i].lift_x
        BODY[i].y += RESTING[i].lift_y
        BODY[i].angle += RESTING[i].lift_angle
        BODY[i].vx += RESTING[i].lift_vx
        BODY[i].vy += RESTING[i].lift_vy
        BODY[i].spin += RESTING[i].lift_spin
        i = A.MEMBER[i].following
    if turned:
        report_lift(A, root)
    paid = min(spent, RESTING[root].payable)
    PAR.external += spent - paid
    PAR.restitution -= paid
    RESTING[root].lost -= paid


@nonallocating
def lift_within_step(A: Scene, i: int, t: float) -> None:
    """Apply the penetration correction of the island of body i, whose interval has ended at instant t within the step
    as was planned, if it has one."""
    root, k, lifted = A.STATE[i].island, A.STATE[i].island, False
    while k >= 0:
        if lift_way(A, k) > 0.0:
            lifted = True
            if len(A.SIDE) > 0:
                hold_sides(A, k, t)
        k = A.MEMBER[k].following
    if lifted:
        apply_correction(A, root, t)
