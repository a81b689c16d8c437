"""Projected Gauss-Seidel sweeps over contact rows: each contact in turn solves its law (`coulomb.py`) with the impulses
of the others fixed; with inverse masses, or the response of jointed components (`columns.py`)."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import Choice, nonallocating
from ..model.contacts import AnyProblem, Problem
from ..model.parameters.impulses import JAMMED
from .build import push_contact
from .columns import push_jointed, sweep_jointed
from .coulomb import coulomb
from .inplace import copy


@nonallocating
def sweep_free(problem: Problem, L: FloatArray, V: FloatArray) -> float:
    """One sweep over the contacts; updates L and V, and returns the largest change of a contact's velocity."""
    ROWS, IM, II, _, _, m = problem
    worst = 0.0
    for i in range(m):
        a, b, nx, ny = ROWS[i].a, ROWS[i].b, ROWS[i].nx, ROWS[i].ny
        na, nb, lam0, beta0 = ROWS[i].arm_na, ROWS[i].arm_nb, L[i, 0], L[i, 1]
        ann, mu = ROWS[i].a_nn, ROWS[i].friction
        dx = V[b, 0] - V[a, 0]
        dy = V[b, 1] - V[a, 1]
        short = nx * dx + ny * dy + (nb * V[b, 2] - na * V[a, 2]) - ROWS[i].target  # u_n - b
        if ROWS[i].wake < np.inf:
            # u_n without its own impulse
            if short + ROWS[i].target - lam0 * ann - beta0 * ROWS[i].a_nt < ROWS[i].wake:
                ROWS[i].wake = np.inf
            else:
                short = np.inf
        if short >= 0.0 and lam0 == 0.0 and beta0 == 0.0:
            continue  # opens
        lam, beta, ta, tb = 0.0, 0.0, 0.0, 0.0
        if mu <= 0.0:
            lam = max(lam0 - ROWS[i].k_n * short, 0.0)
        else:
            ta, tb = ROWS[i].arm_ta, ROWS[i].arm_tb
            ut = nx * dy - ny * dx + (tb * V[b, 2] - ta * V[a, 2]) + ROWS[i].surface
            ant = ROWS[i].a_nt
            qn = short - lam0 * ann - beta0 * ant
            if qn < 0.0:
                # Most contacts stick.
                lam = lam0 - (ROWS[i].w_nn * short + ROWS[i].w_nt * ut)
                beta = beta0 - (ROWS[i].w_nt * short + ROWS[i].w_tt * ut)
                before = ROWS[i].ut
                if abs(beta) <= mu * lam:
                    done = beta * before + lam * min(ROWS[i].un + ROWS[i].target, 0.0) <= 0.0
                else:
                    # Nearly all others slip in the direction of the motion without friction.
                    att = ROWS[i].a_tt
                    qt = ut - beta0 * att - lam0 * ant
                    slope = -mu if qt * ann > qn * ant else mu
                    felt = ann + slope * ant
                    done = False
                    if felt > JAMMED * ann:
                        lam = -qn / felt
                        beta = slope * lam
                        done = slope * (qt + ant * lam + att * beta) <= 0.0 and beta * before <= 0.0
                if not done:
                    att = ROWS[i].a_tt
                    lam, beta = coulomb(
                        qn, ut - beta0 * att - lam0 * ant, ann, ant, att, mu, ROWS[i].un, before, ROWS[i].target
                    )
        dn = lam - lam0
        dt = beta - beta0
        if dn == 0.0 and dt == 0.0:
            continue
        L[i, 0] = lam
        L[i, 1] = beta
        fx = dn * nx - dt * ny
        fy = dn * ny + dt * nx
        V[a, 0] -= IM[a] * fx
        V[a, 1] -= IM[a] * fy
        V[b, 0] += IM[b] * fx
        V[b, 1] += IM[b] * fy
        if dt == 0.0:
            V[a, 2] -= II[a] * (dn * na)
            V[b, 2] += II[b] * (dn * nb)
        else:
            V[a, 2] -= II[a] * (dn * na + dt * ta)
            V[b, 2] += II[b] * (dn * nb + dt * tb)
            worst = max(worst, abs(dt) * ROWS[i].a_tt)
        worst = max(worst, abs(dn) * ann)
    return worst


@nonallocating
def push_free(problem: Problem, L: FloatArray, factor: float, V: FloatArray) -> None:
    """Add factor M^-1 (G^T lam + T^T beta) to V (k, 3)."""
    ROWS, IM, II, _, _, m = problem
    for i in range(m):
        lam = factor * L[i, 0]
        beta = factor * L[i, 1]
        if lam != 0.0 or beta != 0.0:
            push_contact(ROWS[i], IM, II, lam, beta, V)


sweep = Choice(sweep_free, sweep_jointed)
push = Choice(push_free, push_jointed)


@nonallocating
def velocities(problem: AnyProblem, L: FloatArray, FREE: FloatArray, V: FloatArray) -> None:
    """Set V (k, 3) = FREE + W (G^T lam + T^T beta), with the response W of the problem: inverse masses, or columns."""
    copy(V, FREE)
    push(problem, L, 1.0, V)


@nonallocating
def restore_impulses(L: FloatArray, V: FloatArray, L0: FloatArray, V0: FloatArray) -> None:
    """Set impulses L and velocities V to L0 and V0."""
    copy(L, L0)
    copy(V, V0)
