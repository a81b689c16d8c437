"""The ladder of a step: where Newton's method does not converge, the step is divided, then joints become elastic.

Order 2 (midpoint with discrete gradients), or 4 by Suzuki's composition (s, s, 1 - 4s, s, s) h, s = 1/(4 - 4^(1/3)), if
nothing in the component dissipates, drives or meets a limit. The rungs are tried in turn: ORDER_4, WHOLE_STEP, three of
more parts, then those of elastic joints, from ELASTIC_RUNG on. PARTS_ON has their numbers of parts, COMPLIANCE_ON the
compliances of joints over (h / ELASTIC_PARTS)^2: beside the bodies, joints are as soft in a part for any h. The first
elastic rung takes the step as a whole, the others in ELASTIC_PARTS. They begin at a billionth of what the bodies
themselves give, and from the third on become ten times softer from rung to rung, the last time a hundred times.

Joints that contradict one another (`contradicts`) become elastic at once: all rungs before would fail alike. Where a
shorter interval is tried instead, exact joints take the step as a whole or not at all if the interval is long
(PROGRESS.attempt), or if the budget does not pay RESOLUTION times for what the rungs before have taken. The work of all
rungs together is bounded; without work for more than LEAST_SOLUTIONS the order is 2. Elastic joints keep at least the
same compliance in later steps until they are closed.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import nonallocating
from ..model.joint_steps import ELASTIC, EXACT, FINAL, LONG, NEARLY, UNHELD
from ..model.joints import DEPENDENT, GIVES_WAY, INDEPENDENT, ROTARY_SPRING, SPRING, Workspace
from ..model.parameters import joints
from ..model.parameters.joints import BALANCED, JOINT_APART
from ..newton.effort import pays_for_many, work_of_iteration
from ..newton.entries import acting_rows
from ..newton.motion import move
from ..newton.rows import joint_rows
from .bounds import standing
from .foresight import SUZUKI_PARTS, begin_steps, forget_parts, predict_part, recalls, remember_part
from .gains import repay
from .ledger import clear_ledger
from .limits import step_with_limits
from .unheld import restore_start


@nonallocating
def errors_of(W: Workspace, h: float) -> tuple[float, float, float]:
    """At the present iterate of a part h: the sum of the squares of the scaled errors of exact rows; that of the scaled
    forces by which they would pull bodies if joints were elastic; the largest error, over its unit."""
    link, hinge, local = W.link, W.J.HINGE, W.J.LOCAL
    for i in range(W.bodies):
        for c in range(3):
            local[i].impulse[c] = 0.0
    errors, farthest = 0.0, 0.0
    for k in range(W.joints):
        if link[k].bounded != 0 or link[k].rows == 0:
            continue
        joint_rows(W, k, h, False)
        for r in range(acting_rows(link, k)):
            off, scale = hinge[k].value[r] - hinge[k].target[r], hinge[k].scale[r]
            errors += (off * scale) ** 2
            farthest = max(farthest, abs(off) / hinge[k].unit)
            for end in range(2):
                for c in range(3):
                    local[link[k].body[end]].impulse[c] += off * scale**2 * hinge[k].slopes[r, 3 * end + c]
    forces = 0.0
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            forces += local[i].mobility[c] * local[i].impulse[c] ** 2
    return errors, forces, farthest


@nonallocating
def contradicts(W: Workspace, h: float) -> bool:
    """Whether joints contradict one another, at the last iterate of a part h whose solve has failed, and which begins
    at the start of the step: no poses of their bodies fit all of them. Velocities v1 become those of no motion.

    The rows that act ask g(q1) = target of the poses q1 at the end of a part. Neither these functions nor the targets
    depend on its length h, which decides only the impulses that lead there. So where no poses fit, all lengths fail,
    if they have the same rows: if the limits that have been met were met at once, as here.

    Newton's method, with a term on the diagonal for redundant rows, then ends where the errors r = g - target, scaled,
    are least: G^T s^2 r = 0, with the slopes G of the rows and their scales s. Elastic joints would be in equilibrium
    there. If r is not 0, this is a proof where G is constant, as for joints of angles: rows times r s^2 add up to 0 on
    the left of G (q1 - q0) = -r0 for all q1, but not on the right. Of other joints it says that no poses nearby fit. If
    also the errors at the start were as large, they do not arise from the motion, which is less in shorter parts (a
    linkage that is driven beyond its reach): what shorter parts have to close is the same.
    """
    if W.J.PARTS.left != h:
        return False
    errors, forces, farthest = errors_of(W, h)
    if not farthest > JOINT_APART or not forces <= BALANCED**2 * errors:
        return False
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].v1[c] = -W.J.LOCAL[i].v0[c]
    move(W.J.LOCAL, W.bodies, h)
    at_start, _, _ = errors_of(W, h)
    return bool(errors <= at_start and math.isfinite(at_start))


SUZUKI = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
ORDER_4, WHOLE_STEP, ELASTIC_RUNG, RUNGS = 0, 1, 5, 11
PARTS_ON: IntArray = np.array([SUZUKI_PARTS, 1, 2, 4, joints.ELASTIC_PARTS, 1, *5 * [joints.ELASTIC_PARTS]])
COMPLIANCE_ON: FloatArray = np.array([*5 * [0.0], 1e-9, *(1e-9 * 10.0**k for k in range(4)), 1e-4])
TAKEN, FAILED, CONTRADICTED = 0, 1, 2  # what becomes of a rung


@nonallocating
def smooth(W: Workspace) -> bool:
    """Whether order 4 is possible: no damping, no motor, no finite max_force, no joint on a limit."""
    link = W.link
    for k in range(W.joints):
        spring = link[k].kind in (SPRING, ROTARY_SPRING)
        if link[k].bounded != 0 or link[k].side != 0 or (spring and W.J.JOINT[link[k].joint].damping != 0.0):
            return False
    return True


@nonallocating
def has_elastic_joint(W: Workspace) -> bool:
    """Whether a joint of the component is elastic since an earlier step."""
    for k in range(W.joints):
        if W.J.JOINT[W.link[k].joint].touched == GIVES_WAY:
            return True
    return False


@nonallocating
def limit_work(W: Workspace) -> bool:
    """Set the work that this component may take in a step, PROGRESS.limit; whether it is more than the least."""
    component, progress = W.J.COMPONENT[W.s], W.J.PROGRESS
    one = work_of_iteration(component.system, joints.CONDENSED_PASSES, W.joints, component)
    # With no work left, components that are solved easily still are; not what was not solved in this interval before.
    share, least = (progress.budget - progress.effort) * joints.COMPONENT_BUDGET, joints.LEAST_SOLUTIONS * one
    if W.J.STEPPED[W.s].status == UNHELD:
        least = 0.0
    progress.limit = progress.effort + max(share, least)
    return bool(share > least)


@nonallocating
def compliance_on(rung: int, h: float, yields: bool, before: float) -> float:
    """The compliance (time²) of joints on a rung; if joints are elastic already (`yields`), not less than `before`, and
    just that on the first two rungs."""
    compliance = float(COMPLIANCE_ON[rung] * (h / joints.ELASTIC_PARTS) ** 2)
    return max(compliance if rung > ELASTIC_RUNG + 1 else 0.0, before) if yields else compliance


@nonallocating
def take_parts(W: Workspace, h: float, extent: float, rung: int, compliance: float, cold: bool) -> int:
    """Take the step h in the parts of a rung: TAKEN, FAILED if one of them fails, or CONTRADICTED if exact joints
    contradict one another at its start. Energies are added to RUNG_LEDGER.

    Args:
        extent: size of the component.  compliance: of joints, time².
        cold: rows are redundant, and those without bounds begin without impulse.
    """
    parts, before = int(PARTS_ON[rung]), h
    give = compliance / (h / parts) ** 2
    if rung == ORDER_4:
        begin_steps(W, h)
    for p in range(parts):
        if parts > 1:
            W.J.COMPONENT[W.s].parts = 0
        piece = h / parts if rung > ORDER_4 else (1.0 - 4.0 * SUZUKI) * h if p == SUZUKI_PARTS // 2 else SUZUKI * h
        for k in range(W.joints):
            warm = 0.0 if cold and W.link[k].bounded == 0 else piece / before
            W.J.HINGE[k].lam[0] *= warm
            W.J.HINGE[k].lam[1] *= warm
        before = piece
        if rung == ORDER_4 and recalls(W):
            predict_part(W, p, piece, cold)
        if not step_with_limits(W, False, piece, extent, cold, give, rung == ORDER_4):
            redundant = standing(W) or W.J.COMPONENT[W.s].dependence == DEPENDENT
            exact = p == 0 and rung < ELASTIC_RUNG
            return CONTRADICTED if exact and redundant and contradicts(W, piece) else FAILED
        if rung == ORDER_4:
            remember_part(W, piece)
    return TAKEN


@nonallocating
def climb(W: Workspace, h: float, order: int, extent: float, touched: bool, own: bool) -> int:
    """Take the step h by the first rung of the ladder that succeeds: EXACT, NEARLY or ELASTIC; UNHELD if none does,
    with everything as at the start. RUNG_LEDGER has the energies.

    | | whether |
    |---|---|
    | yields | a joint is elastic since an earlier step: rungs of exact joints would fail again |
    | cyclic, sure | rows may be redundant; and were found to be independent at the start of the step |
    | cold | a rung begins without impulses: dependent rows that do not pull hard (`taut`); after a fail all `cyclic` |
    | dear | a shorter interval may be tried, and the budget does not pay RESOLUTION times for the rungs so far |
    | again | a rung has begun with predicted values, or impulses of cycles: it is tried once more without |
    | tight | redundant rows have failed in the whole step: it is tried once more with the least `epsilon` |

    Args:
        touched: whether joints were edited.  own: whether only steps have left them apart, see `repay`.
    """
    first, progress = W.J.JOINT[W.link[0].joint], W.J.PROGRESS
    component, cyclic = W.J.COMPONENT[W.s], W.J.COMPONENT[W.s].cycles > 0
    cold, yields = component.dependence == DEPENDENT and component.taut == 0, has_elastic_joint(W)
    rung = ELASTIC_RUNG if yields else ORDER_4 if order == 4 and smooth(W) else WHOLE_STEP
    if rung != ORDER_4 or touched:
        forget_parts(W)
    progress.most_epsilon, begun = joints.REDUNDANT_MOST, progress.effort
    while rung < RUNGS and not progress.effort > progress.limit:
        dear = progress.attempt > FINAL and not pays_for_many(progress, begun)
        if (progress.attempt == LONG or dear) and WHOLE_STEP < rung < ELASTIC_RUNG:
            break
        compliance = compliance_on(rung, h, yields, first.compliance)
        clear_ledger(W.J.RUNG_LEDGER)
        outcome = take_parts(W, h, extent, rung, compliance, cold)
        if outcome == TAKEN and (rung >= ELASTIC_RUNG or repay(W, h, extent, own)):
            first.compliance = compliance
            return EXACT if rung <= WHOLE_STEP else NEARLY if rung < ELASTIC_RUNG else ELASTIC
        sure = component.dependence == INDEPENDENT
        again = (cold != cyclic and not (sure and rung == ORDER_4)) or (rung == ORDER_4 and recalls(W))
        if sure:  # rows may become dependent within the step, as where it passes a dead centre
            component.dependence = DEPENDENT
        restore_start(W)
        forget_parts(W)
        tight = cyclic and rung == WHOLE_STEP and not again and progress.most_epsilon == joints.REDUNDANT_MOST
        rung, cold = ELASTIC_RUNG if outcome == CONTRADICTED else rung if again or tight else rung + 1, cyclic
        # Compliance makes rows independent by itself.
        progress.most_epsilon = joints.REDUNDANT_EPSILON if tight or rung >= ELASTIC_RUNG else joints.REDUNDANT_MOST
    return UNHELD
