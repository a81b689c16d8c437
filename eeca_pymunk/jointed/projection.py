"""Velocities at the end of a lossy interval are projected onto the joints; contacts are kept from closing by that."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..contacts.works import kinetic_energy
from ..joints.correct import loss_of_projection
from ..joints.workspace import workspace
from ..model.contacts import JointedProblem
from ..model.joints import Joints
from ..model.parameters.joints import PROJECTED_CLOSING, PROJECTED_ENERGY, PROJECTED_RESIDUAL
from ..model.scene import Scene
from ..rows.bounded import room_for_rows
from ..rows.build import normal_rate
from .advance import Interval, find_hit, join_points, separation
from .columns import fill_unjointed, make_columns, set_effective_masses
from .component import project_speeds
from .correction import fill_at_end, raise_gaps
from .gathered import gather_component, number_of


@kernel
def project_velocities(A: Scene, J: Joints, interval: Interval, L: FloatArray, scale: float) -> FloatArray:
    """Project the velocities at the end of a lossy interval onto the joints of the components that contacts push.

    Bodies that land have velocities there which violate joints. The midpoint rule would change the sign of this
    violation in every step, without end. The ledger has the loss. In islands of few contacts those that push are kept
    from closing (`stop_closing`), unless that would change the speed of a motor of unlimited force. Bounded impulses
    act over times and are left out here. `scale` is a speed of the island.

    Returns:
        (m,) normal impulses that keep contacts from closing, which are in the ledger.
    """
    isle, groups, ROWS, motion, _, m, _, t, h, _ = interval
    ZERO = np.zeros_like(isle.V)
    LOADED = np.zeros(len(groups.COMPONENT) + 1, np.int64)  # one more, for GROUP -1
    for i in range(m):
        if L[i, 0] > 0.0:
            LOADED[groups.GROUP[ROWS[i].a] + 1] = LOADED[groups.GROUP[ROWS[i].b] + 1] = 1
    payer, DRIVEN = -1, np.zeros(len(groups.COMPONENT) + 1, np.int64)
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        if s < 0:
            continue
        component, DRIVEN[g + 1] = J.COMPONENT[s], J.COMPONENT[s].driven
        # Impulses at one instant move bodies freely whose joints are all bounded.
        if LOADED[g + 1] == 0 or component.bounded_joints == component.end_joint - component.first_joint:
            continue
        payer = s if payer < 0 else payer
        extent = gather_component(A, J, s, motion.END, motion.V, ZERO, isle.IM, isle.II, t + h, h)
        project_speeds(J, s, extent)
        J.STEPPED[s].projected += loss_of_projection(workspace(J, s), J.STEPPED[s])
        for w in range(component.end_body - component.first_body):
            q = number_of(A, J, s, w)
            for c in range(3 if q >= 0 else 0):
                motion.V[q, c] = J.LOCAL[w].v0[c]
    if payer < 0 or not interval.few:
        return np.zeros(m)
    PUSHING, pushing, fastest = np.empty(m, np.int64), 0, 0.0
    for i in range(m):
        driven = DRIVEN[groups.GROUP[ROWS[i].a] + 1] + DRIVEN[groups.GROUP[ROWS[i].b] + 1] > 0
        if L[i, 0] > 0.0 and interval.C.LEFT_OUT[i] == 0 and not driven:
            PUSHING[pushing] = i
            pushing += 1
            fastest = max(fastest, -normal_rate(ROWS[i], motion.V))
    if fastest > PROJECTED_CLOSING * scale:
        return stop_closing(A, J, interval, PUSHING[:pushing], PROJECTED_RESIDUAL * fastest, payer)
    return np.zeros(m)


@kernel
def stop_closing(A: Scene, J: Joints, interval: Interval, PUSHING: IntArray, fine: float, payer: int) -> FloatArray:
    """Normal impulses mu (m,), 0 <= mu _|_ u + G S G^T mu >= 0, on the contacts PUSHING, whose rates are u, with S the
    response of components at one instant: velocities that hold the joints still do, and contacts do not close. Energy
    changes by mu.(u + G S G^T mu / 2) <= 0, also if sweeps end early. Component `payer` has the loss in its ledger."""
    isle, groups, ROWS, motion, _, m, n, _, _, _ = interval
    pushing, KEEP = len(PUSHING), ROWS[: len(PUSHING)].copy()
    for i in range(pushing):
        KEEP[i] = ROWS[PUSHING[i]]
        along, across = separation(KEEP[i], motion.END)
        # They have moved apart. A body that is fixed is the second one.
        join_points(KEEP[i], along, across, 0.5 if isle.IM[KEEP[i].b] > 0.0 else 0.0)
    C = make_columns(groups, KEEP, pushing)
    fill_unjointed(groups, C, KEEP, isle.IM, isle.II, pushing)
    HIT = find_hit(groups, KEEP, pushing)
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        if s < 0 or HIT[g] == 0:
            continue
        if not fill_at_end(A, J, interval, C, g, KEEP, pushing):
            return np.zeros(m)
    set_effective_masses(groups, C, KEEP, pushing)
    RATES = np.empty(pushing)
    for i in range(pushing):
        RATES[i] = normal_rate(KEEP[i], motion.V)
    D, before = np.zeros_like(motion.V), kinetic_energy(motion.V, isle.IM, isle.II, n)
    MU = raise_gaps(JointedProblem(KEEP, C, room_for_rows(0, 0), pushing), n, RATES, D, fine)
    HELD, loss = np.zeros(m), 0.0
    for i in range(pushing):
        HELD[PUSHING[i]] = MU[i]
        if MU[i] > 0.0:
            loss -= MU[i] * (RATES[i] + 0.5 * normal_rate(KEEP[i], D))
    for q in range(len(D)):
        for c in range(3):
            motion.V[q, c] += D[q, c]
    gained = kinetic_energy(motion.V, isle.IM, isle.II, n) - before
    if abs(gained + loss) > PROJECTED_ENERGY * before:
        # Supports move.
        J.STEPPED[payer].projected += loss
        J.STEPPED[payer].supports += gained + loss
    else:
        J.STEPPED[payer].projected -= gained
    return HELD
