"""Islands at rest that support moving bodies.

One disk that rolls on a pile moves nothing else. So slow bodies may be at rest while the rest of their island moves:
for the moving bodies they are fixed, as the ground is, and a statics problem of the bodies at rest, under the forces
with which the others push on them, shows whether that is right. If these forces and those of their own contacts balance
inside all friction cones, they solve the contact problem of all bodies together: the bodies at rest have no motion, and
momentum passes through them to what is fixed. Otherwise all of them are solved as one island.

In each step moving islands are solved first, then the forces in islands that support them, starting from those of the
last step. A contact between both belongs to the moving island, which wakes when its support does.
"""

from __future__ import annotations

from ..compiled import kernel
from ..model.bodies import AT_REST
from ..model.parameters.rest import SUPPORT_FACTORS, SUPPORT_ROUNDS
from ..model.scene import Scene
from .accounting import wake
from .intervals import begin_interval
from .loads import mark_loaded, unsupported
from .local import drop_ended
from .membership import members_of
from .rest import postpone_test


@kernel
def support(A: Scene) -> None:
    """At the start of a step, after moving islands have been solved: solve the forces in islands at rest that support
    them; those that cannot support their loads wake, and are solved with what rests on them."""
    STATE, MEMBER, BODY = A.STATE, A.MEMBER, A.BODY
    more, all_moving, rounds = A.COUNT.may_support > 0, True, 0
    while more:
        # Mark the islands at rest on which others press with forces that have not been tested: moving islands, in the
        # first round and after one was solved, and islands at rest with new forces.
        for c in range(A.COUNT.pushes):
            root = A.PUSHED_BY[c].root
            if root < 0 or not (MEMBER[root].new_forces == 1 if MEMBER[root].rest == AT_REST else all_moving):
                continue
            mark_loaded(A, c)
        more, all_moving = False, False
        for i in range(BODY.shape[0] - 1):
            MEMBER[i].new_forces = 0
        for i in range(BODY.shape[0] - 1):
            if MEMBER[i].unverified == 0:
                continue
            MEMBER[i].unverified = 0
            if STATE[i].island != i or MEMBER[i].rest != AT_REST:
                continue
            more = True
            # After SUPPORT_ROUNDS: islands that support each other are solved as one.
            if rounds < SUPPORT_ROUNDS and unsupported(A, i, A.PAR.dt, SUPPORT_FACTORS) == 0.0:
                MEMBER[i].new_forces = 1
            else:
                postpone_test(A, members_of(A, i))
                root, all_moving = wake(A, i, 0.0), True
                drop_ended(A)  # so that there is room for an island that is solved again and again
                begin_interval(A, root, 0.0)
        rounds += 1
