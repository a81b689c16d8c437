"""Islands jointed to a moving body, if the step ends at another instant than the one at which they are."""

from __future__ import annotations

from ..compiled import kernel
from ..joints.bounds import hold_passed
from ..joints.closing import close_poses, farthest
from ..joints.start import compute_rows, springs_of
from ..joints.workspace import workspace
from ..model.joints import Joints
from ..model.parameters.joints import LINEAR_APART
from ..model.scene import Scene
from .component import keep_apart, size_joints
from .ends import components_of
from .gathered import gather_alone
from .rest import has_moving_partner


@kernel
def carry(A: Scene, J: Joints, root: int, t: float) -> None:
    """Move an island whose bodies are at an earlier instant to t, the end of the step, as far as its joints with moving
    partners require it, along M^-1 G^T: otherwise these joints would be apart by the partners' way. The work against
    all forces on the bodies is the partners', external."""
    began = A.BODY[root].since
    if began == t:
        return
    for s in components_of(A, J, root):
        if not has_moving_partner(A, J, s):
            continue
        W, first = workspace(J, s), J.COMPONENT[s].first_body
        size_joints(W, gather_alone(A, J, s, began, A.PAR.planned))
        for k in range(W.joints):
            W.link[k].side = W.J.JOINT[W.link[k].joint].side
        stored = springs_of(W)
        if hold_passed(W):
            compute_rows(W)
        keep_apart(W)
        gather_alone(A, J, s, t, A.PAR.planned)
        close_poses(W)
        stored = springs_of(W) - stored
        if not farthest(W) <= LINEAR_APART:
            continue
        work = stored
        for w in range(W.bodies):
            if J.LOCAL[w].freedoms == 0:
                continue
            i, place = int(J.JOINED[first + w].body), J.LOCAL[w].pose
            body = A.BODY[i]
            work -= (A.PULL[i, 0] * (place[0] - body.x) + A.PULL[i, 1] * (place[1] - body.y)) / body.inv_mass
            if body.inv_inertia > 0.0:
                work -= A.PULL[i, 2] * (place[2] - body.angle) / body.inv_inertia
            body.x, body.y, body.angle = place[0], place[1], place[2]
        A.PAR.stored += stored
        A.PAR.external += work
