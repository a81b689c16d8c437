"""Islands at rest: their last solve remains valid from step to step, and they are not solved again.

`rest.py` determines which islands come to rest. Their bodies keep their poses, without velocity (the remaining kinetic
energy enters the ledger as restitution; disks without friction keep their spin), and their contacts keep their forces.
An island is solved again when one of its bodies is hit or edited, when the accelerations on it change, when a body that
supports it moves, and when collision handlers or joints give other laws to pairs of shapes than in the last step.

`Member.rest` is AT_REST for all its bodies; for the root CHANGED once it has to be solved again.
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..contacts.forces import find, key_of
from ..contacts.single import log_impulse
from ..contacts.works import kinetic
from ..model.bodies import AT_REST, AWAKE, CHANGED
from ..model.contacts import LASTED
from ..model.parameters.rest import REST_RETRY
from ..model.scene import Scene
from ..pairs.rules import checksum, mark_pair
from .membership import pressed_island
from .rest import candidate_speed, speed, spins_freely


@nonallocating
def unchanged(A: Scene, i: int) -> bool:
    """Whether body i has no velocity, apart from a free spin, and the pose that the last step has left."""
    BODY, BEGAN = A.BODY, A.BEGAN
    same = BODY[i].x == BEGAN[i, 0] and BODY[i].y == BEGAN[i, 1] and BODY[i].angle == BEGAN[i, 2]
    return bool(same and BODY[i].vx == 0.0 and BODY[i].vy == 0.0 and (BODY[i].spin == 0.0 or spins_freely(A, i)))


@nonallocating
def moves_itself(A: Scene, i: int) -> bool:
    """Whether body i, without mobility, moves in this step, or the program has moved it."""
    return bool(A.BODY[i].inv_mass == 0.0 and A.MEMBER[i].rest == CHANGED)


@nonallocating
def stays_at_rest(A: Scene, i: int, last: float) -> bool:
    """Whether nothing has changed for body i of an island at rest, at the start of a step; `last`: length of the last
    step. Then its path remains and its predicted event comes `last` earlier; else its island is CHANGED."""
    BODY = A.BODY
    pulled = BODY[i].ax == A.PULL[i, 0] and BODY[i].ay == A.PULL[i, 1] and BODY[i].angular == A.PULL[i, 2]
    if A.MEMBER[i].busy > 0 or not pulled or not unchanged(A, i):
        A.MEMBER[A.STATE[i].island].rest = CHANGED
        return False
    BODY[i].ax, BODY[i].ay, BODY[i].angular = 0.0, 0.0, 0.0
    # A timer below 0 advances at rest too: an island that often wakes is tested less often.
    A.RESTING[i].rest_timer = min(A.RESTING[i].rest_timer + 1.0, 0.0)
    BODY[i].due = max(A.RESTING[i].rest_due - last, 0.0)
    return True


@nonallocating
def disturb(A: Scene, i: int) -> None:
    """Let an island at rest of body i be solved again."""
    root = A.STATE[i].island
    if root >= 0 and A.MEMBER[root].rest == AT_REST:
        A.MEMBER[root].rest = CHANGED


@nonallocating
def renew_forces(A: Scene, c: int) -> None:
    """Let the remembered forces of contact c, if they are of the last step, be of this one."""
    key = key_of(A, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b)
    for z in range(2):
        row = find(A.KEYS, key + z)
        if row >= 0 and A.FORCES[row].stamp >= A.PAR.stamp - 1.0:
            A.FORCES[row].stamp = A.PAR.stamp


@nonallocating
def wake_supported(A: Scene) -> None:
    """Set islands CHANGED that are supported by islands that are CHANGED, and so on."""
    MEMBER, more = A.MEMBER, A.COUNT.may_support > 0
    while more:
        more = False
        for c in range(A.COUNT.pushes):
            root = A.PUSHED_BY[c].root
            if root < 0 or MEMBER[root].rest == CHANGED:
                continue
            for shape in (A.PUSHED_BY[c].a, A.PUSHED_BY[c].b):
                other = pressed_island(A, c, shape)
                if other >= 0 and MEMBER[other].rest == CHANGED:
                    MEMBER[root].rest, more = CHANGED, True


@nonallocating
def mark_changed_contacts(A: Scene) -> None:
    """Set islands at rest CHANGED that touch what moves by itself, and all if other laws hold for pairs."""
    rules = checksum(A.RULE)
    ruled, A.PAR.rules = rules != A.PAR.rules, rules
    for c in range(A.COUNT.pushes):
        root, a, b = A.PUSHED_BY[c].root, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b
        if root >= 0 and (ruled or moves_itself(A, A.LINK[a].owner) or moves_itself(A, A.LINK[b].owner)):
            A.MEMBER[root].rest = CHANGED


@nonallocating
def renew_contacts(A: Scene) -> None:
    """Let contacts of islands at rest act over this step; those of islands that are CHANGED are LASTED."""
    for c in range(A.COUNT.pushes):
        root = A.PUSHED_BY[c].root
        if root >= 0 and A.MEMBER[root].rest == CHANGED:
            A.PUSHED_BY[c].root = LASTED
            mark_pair(A, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, 0)
        elif root >= 0:
            pushed = A.PUSHED[c]
            longer = A.PAR.dt / pushed.length
            pushed.normal *= longer
            pushed.tangential *= longer
            pushed.change *= longer
            pushed.length = A.PAR.dt


@nonallocating
def restart_paths(A: Scene) -> None:
    """Advance the rest timers of bodies in islands that are not at rest. Bodies whose rest has ended begin a new path;
    all are predicted again."""
    STATE, MEMBER, BODY = A.STATE, A.MEMBER, A.BODY
    most = A.PAR.pulled * A.PAR.dt
    for i in range(BODY.shape[0] - 1):
        root = STATE[i].island
        if root < 0 or MEMBER[root].rest == AT_REST:
            continue
        slow = speed(A, i) <= candidate_speed(MEMBER[root].with_supports) * most
        A.RESTING[i].rest_timer = A.RESTING[i].rest_timer + 1.0 if slow else 0.0
        if MEMBER[i].rest != AWAKE:
            # On its path at rest a body has no acceleration (`put_to_rest`).
            BODY[i].ax, BODY[i].ay, BODY[i].angular = A.PULL[i, 0], A.PULL[i, 1], A.PULL[i, 2]
            STATE[i].version += 1
        # Its predicted event does not contain the pairs of its last interval.
        BODY[i].due = min(BODY[i].due, 0.0)


@nonallocating
def dissolve_islands(A: Scene) -> None:
    """Dissolve all islands except those at rest."""
    STATE, MEMBER = A.STATE, A.MEMBER
    for i in range(A.BODY.shape[0] - 1):
        root = STATE[i].island
        if root >= 0 and MEMBER[root].rest != AT_REST:
            STATE[i].island = -1
            if i != root:  # the others of its island read that of the root
                MEMBER[i].rest = AWAKE
        elif root >= 0:
            A.RESTING[i].lost, MEMBER[i].hits = 0.0, 0
    for i in range(A.BODY.shape[0] - 1):
        if STATE[i].island < 0 and A.BODY[i].inv_mass > 0.0:
            MEMBER[i].rest = AWAKE


@nonallocating
def wake_changed(A: Scene) -> None:
    """At the start of a step: dissolve all islands except those at rest for which nothing has changed. `begin` has set
    those CHANGED whose bodies have. In this order, as each part reads what the one before has set:

    part                    reads                              sets
    mark_changed_contacts   rest of kinematic bodies, rules    rest of roots: CHANGED
    wake_supported          rest of roots                      rest of the roots that these support: CHANGED
    renew_contacts          rest of roots                      which contacts remain, with their impulses of this step
    restart_paths           rest of roots and bodies           rest timers, accelerations, path versions
    dissolve_islands        rest of roots                      islands, rest of their bodies: AWAKE
    """
    mark_changed_contacts(A)
    wake_supported(A)
    renew_contacts(A)
    restart_paths(A)
    dissolve_islands(A)


@nonallocating
def set_awake(A: Scene, root: int) -> None:
    """Set the bodies of an island at rest, which is hit or joined in this step, AWAKE; its interval then ends as any
    other. The remembered forces of its contacts count as those of this step."""
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root == root:
            renew_forces(A, c)
    i = root
    while i >= 0:
        A.MEMBER[i].rest = AWAKE
        i = A.MEMBER[i].following


@nonallocating
def log_contact(A: Scene, c: int, part: float, duration: float) -> None:
    """Log this part of the impulse of contact c of an interval, over this time from the start of the interval on."""
    pushed, COUNT = A.PUSHED[c], A.COUNT
    if COUNT.logged < A.LOG.shape[0]:
        log_impulse(
            A.LOG[COUNT.logged], A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, pushed.start + 0.5 * duration,
            part * pushed.normal + pushed.held, part * pushed.tangential, pushed.nx, pushed.ny, pushed.px, pushed.py,
            part * pushed.change, pushed.gap,
        )  # fmt: skip
        A.LOG[COUNT.logged].duration = duration
        COUNT.logged += 1


@nonallocating
def report_at_rest(A: Scene, c: int) -> None:
    """At the end of a step: log the impulse of contact c of an island at rest, which was that of the step as planned,
    and renew its remembered forces."""
    renew_forces(A, c)
    if A.PUSHED[c].normal != 0.0 or A.PUSHED[c].tangential != 0.0:
        log_contact(A, c, A.PAR.dt / A.PAR.planned, A.PAR.dt)


@nonallocating
def stop(A: Scene, i: int) -> None:
    """Set the velocity of body i to 0, apart from a free spin; its kinetic energy is lost to restitution."""
    BODY = A.BODY
    A.PAR.restitution += kinetic(BODY, i)
    BODY[i].vx, BODY[i].vy = 0.0, 0.0
    if spins_freely(A, i):
        A.PAR.restitution -= kinetic(BODY, i)
    else:
        BODY[i].spin = 0.0
    A.STATE[i].version += 1


@nonallocating
def put_to_rest(A: Scene, root: int) -> None:
    """At the start of a step: put an island to rest. Its bodies stop, apart from free spins."""
    BODY, MEMBER = A.BODY, A.MEMBER
    MEMBER[root].new_forces = 1
    i = root
    while i >= 0:
        stop(A, i)
        BODY[i].ax, BODY[i].ay, BODY[i].angular = 0.0, 0.0, 0.0
        MEMBER[i].rest, BODY[i].due, A.RESTING[i].rest_timer = AT_REST, 0.0, -float(REST_RETRY)
        i = MEMBER[i].following


@nonallocating
def store_rest(A: Scene) -> None:
    """At the end of a step: store the poses and next events of bodies at rest, which the next step compares."""
    for i in range(A.BODY.shape[0] - 1):
        if A.MEMBER[i].rest == AT_REST:
            A.RESTING[i].rest_due = A.BODY[i].due
            A.BEGAN[i, 0], A.BEGAN[i, 1], A.BEGAN[i, 2] = A.BODY[i].x, A.BODY[i].y, A.BODY[i].angle
