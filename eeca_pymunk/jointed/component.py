"""One component (bodies connected by joints) within an island of the event loop."""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..joints.bounds import passed_side
from ..joints.correct import hold_passed_by, project
from ..joints.start import compute_rows, springs_of
from ..joints.step import take_step
from ..joints.workspace import workspace
from ..model.joint_steps import POSES, SPEEDS
from ..model.joints import Joints, Workspace
from ..model.parameters.joints import COMPONENT_WORK, COMPONENT_WORK_BODY, CORRECTION_JOINTS
from ..model.scene import Scene
from ..newton.entries import acts
from ..newton.rows import unit_of
from .gathered import gather_component, number_of


@nonallocating
def step_in_scratch(J: Joints, s: int, h: float, extent: float, untouched: bool) -> None:
    """Step component s by h from the state in its scratch, which then has the end. The status is in STEPPED.

    `untouched`: whether order 4 is allowed, as no contact acts in the interval.
    """
    J.PROGRESS.effort += COMPONENT_WORK + COMPONENT_WORK_BODY * (J.COMPONENT[s].end_body - J.COMPONENT[s].first_body)
    J.STEPPED[s].status = take_step(workspace(J, s), h, J.TALLY.order if untouched else 2, extent, J.STEPPED[s])


@inlined
def size_joints(W: Workspace, extent: float) -> None:
    """Units of the joints' functions in a component of size `extent`, whose targets are 0: the scratch has those of
    the component that was stepped last."""
    for k in range(W.joints):
        W.J.HINGE[k].unit = unit_of(W.J.JOINT[W.link[k].joint], extent)
        W.J.HINGE[k].target[0] = W.J.HINGE[k].target[1] = 0.0


@nonallocating
def project_speeds(J: Joints, s: int, extent: float) -> None:
    """Project the velocities that `gather_component` has put into the scratch onto the joints and closed limits: an
    impact without bounce. The caller accounts for the loss."""
    W = workspace(J, s)
    size_joints(W, extent)
    project(W, SPEEDS)


@nonallocating
def keep_apart(W: Workspace) -> None:
    """Set the targets of all rows that act to their present values, so that joints which are apart stay as far apart.
    Rows must be those of the present poses."""
    for k in range(W.joints):
        for r in range(W.link[k].rows):
            W.J.HINGE[k].target[r] = W.J.HINGE[k].value[r] if acts(W.link, k, r) else 0.0


@nonallocating
def close_at_poses(
    A: Scene, J: Joints, s: int, OLD: FloatArray, NEW: FloatArray, V: FloatArray, IM: FloatArray, II: FloatArray,
    t: float, h: float,
) -> float:  # fmt: skip
    """Close the joints of component s at the poses NEW (k, 3) of an island, along M^-1 G^T. Returns by how much more
    energy its springs store there than at OLD; infinity if joints do not close or limits are passed."""
    W = workspace(J, s)
    extent = gather_component(A, J, s, OLD, V, V, IM, II, t, h)
    size_joints(W, extent)
    stored = springs_of(W)
    keep_apart(W)
    gather_component(A, J, s, NEW, V, V, IM, II, t, h)
    project(W, POSES)
    for i in range(W.bodies):
        q = number_of(A, J, s, i)
        for c in range(3 if q >= 0 else 0):
            NEW[q, c] = J.LOCAL[i].pose[c]
    stored = springs_of(W) - stored
    for k in range(W.joints):
        link, hinge = W.link[k], W.J.HINGE[k]
        if link.bounded != 0:
            continue
        for r in range(link.rows):
            if acts(W.link, k, r) and abs(hinge.value[r] - hinge.target[r]) > CORRECTION_JOINTS * hinge.unit:
                return math.inf
        passed = passed_side(W, k, CORRECTION_JOINTS)
        if passed != 0 and passed != link.side:
            return math.inf
    return stored


@nonallocating
def passes_limit(
    A: Scene, J: Joints, s: int, POSE: FloatArray, D: FloatArray, IM: FloatArray, II: FloatArray, t: float, h: float,
    least: float,
) -> bool:  # fmt: skip
    """Let limits of component s act that displacements D (k, 3) from the poses POSE (k, 3) pass by more than the length
    `least`. Returns whether there are any."""
    W = workspace(J, s)
    extent = gather_component(A, J, s, POSE, D, D, IM, II, t, h)
    size_joints(W, extent)
    for i in range(W.bodies):
        if number_of(A, J, s, i) < 0:  # partners stay where they are
            for c in range(3):
                J.LOCAL[i].v0[c] = 0.0
    compute_rows(W)
    return hold_passed_by(W, least / extent)
