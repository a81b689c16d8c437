"""Projected Gauss-Seidel sweeps over contact rows with the exact local law of Coulomb friction.

Each contact in turn solves, with the others' impulses frozen,

    0 <= lam  _|_  u_n - b >= 0,   |beta| <= mu lam,   u_t = 0 or beta = -mu lam sign(u_t),

its own 2 x 2 matrix ((A_nn, A_nt), (A_nt, A_tt)) included: sticking, else slipping one way or the other, else no
friction. Newton's law with friction creates energy where the slip reverses; therefore each contact's loss
D_n + D_t = -lam (u_n- + b)/2 - beta (u_t- + u_t+)/2 is kept from being negative (friction is cut where it would be).
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.contacts import Row
from ..model.parameters.impulses import JAMMED, SINGULAR


@uncounted
def coulomb(
    qn: float, qt: float, ann: float, ant: float, att: float, mu: float, un: float, ut: float, target: float
) -> tuple[float, float]:
    """(lam, beta) of one contact whose velocities without impulse are u_n = target + qn and u_t = qt.

    `un`, `ut` are its velocities before the step (or impact), from which the loss counts. Closed form.
    """
    if qn >= 0.0:
        return 0.0, 0.0
    det = ann * att - ant * ant
    lam = 0.0
    beta = 0.0
    done = False
    if det > SINGULAR * ann * att:
        lam = (qt * ant - qn * att) / det
        beta = (qn * ant - qt * ann) / det
        done = lam >= 0.0 and abs(beta) <= mu * lam
    if not done:
        # Slipping against the motion there would be without friction, then the other way (Painleve: neither).
        sign = -1.0 if qt - qn * ant / ann > 0.0 else 1.0
        for _ in range(2):
            den = ann + sign * mu * ant
            if den > JAMMED * ann:
                lam = -qn / den
                beta = sign * mu * lam
                if sign * (qt + ant * lam + att * beta) <= 0.0:
                    done = True
                    break
            sign = -sign
        if not done:
            return -qn / ann, 0.0
    if beta * ut > 0.0:
        # With lam = -(qn + ant beta) / ann the loss is a quadratic in T = |beta|: s T^2 + p T + c <= 0, c <= 0.
        sign = 1.0 if beta > 0.0 else -1.0
        loss = min(un + target, 0.0) / ann
        s = max(det, 0.0) / ann
        p = sign * (ut + qt - ant * qn / ann - ant * loss)
        c = -qn * loss
        T = abs(beta)
        if T * (s * T + p) + c > 0.0:
            root = math.sqrt(max(p * p - 4.0 * s * c, 0.0))
            most = -2.0 * c / (p + root) if p > 0.0 else (root - p) / (2.0 * s)
            beta = sign * min(T, max(most, 0.0))
            lam = -(qn + ant * beta) / ann
            if lam < 0.0:
                return 0.0, 0.0
            if abs(beta) > mu * lam:
                lam = -qn / (ann + sign * mu * ant)
                beta = sign * mu * lam
    return lam, beta


@uncounted
def sweep(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, IM: FloatArray, II: FloatArray, m: int
) -> float:
    """One sweep over the m contacts; L and V are updated. Returns the largest change of a contact's velocity."""
    worst = 0.0
    for i in range(m):
        a = A[i]
        b = B[i]
        nx = ROWS[i].nx
        ny = ROWS[i].ny
        na = ROWS[i].arm_na
        nb = ROWS[i].arm_nb
        lam0 = L[i, 0]
        beta0 = L[i, 1]
        ann = ROWS[i].a_nn
        mu = ROWS[i].friction
        dx = V[b, 0] - V[a, 0]
        dy = V[b, 1] - V[a, 1]
        short = nx * dx + ny * dy + (nb * V[b, 2] - na * V[a, 2]) - ROWS[i].target  # u_n - b
        if ROWS[i].wake < np.inf:
            if short + ROWS[i].target - lam0 * ann < ROWS[i].wake:
                ROWS[i].wake = np.inf
            else:
                short = np.inf
        if short >= 0.0 and lam0 == 0.0 and beta0 == 0.0:
            continue  # opens
        lam = 0.0
        beta = 0.0
        ta = 0.0
        tb = 0.0
        if mu <= 0.0:
            lam = max(lam0 - ROWS[i].k_n * short, 0.0)
        else:
            ta = ROWS[i].arm_ta
            tb = ROWS[i].arm_tb
            ut = nx * dy - ny * dx + (tb * V[b, 2] - ta * V[a, 2]) + ROWS[i].surface
            ant = ROWS[i].a_nt
            qn = short - lam0 * ann - beta0 * ant
            if qn < 0.0:
                # Most stick, and need no more than this.
                lam = lam0 - (ROWS[i].w_nn * short + ROWS[i].w_nt * ut)
                beta = beta0 - (ROWS[i].w_nt * short + ROWS[i].w_tt * ut)
                before = ROWS[i].ut
                if abs(beta) <= mu * lam:
                    done = beta * before + lam * min(ROWS[i].un + ROWS[i].target, 0.0) <= 0.0
                else:
                    # Nearly all others slip as they would without friction.
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


@uncounted
def push(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, IM: FloatArray, II: FloatArray, m: int
) -> None:
    """V += M^-1 (G^T lam + T^T beta)."""
    for i in range(m):
        lam = L[i, 0]
        beta = L[i, 1]
        if lam == 0.0 and beta == 0.0:
            continue
        a = A[i]
        b = B[i]
        fx = lam * ROWS[i].nx - beta * ROWS[i].ny
        fy = lam * ROWS[i].ny + beta * ROWS[i].nx
        V[a, 0] -= IM[a] * fx
        V[a, 1] -= IM[a] * fy
        V[a, 2] -= II[a] * (lam * ROWS[i].arm_na + beta * ROWS[i].arm_ta)
        V[b, 0] += IM[b] * fx
        V[b, 1] += IM[b] * fy
        V[b, 2] += II[b] * (lam * ROWS[i].arm_nb + beta * ROWS[i].arm_tb)


@uncounted
def velocities(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, FREE: FloatArray, IM: FloatArray, II: FloatArray, m: int,
    V: FloatArray,
) -> None:  # fmt: skip
    """V = FREE + M^-1 (G^T lam + T^T beta)."""
    for i in range(len(IM)):
        for c in range(3):
            V[i, c] = FREE[i, c]
    push(A, B, ROWS, L, V, IM, II, m)


@uncounted
def keep(L: FloatArray, V: FloatArray, m: int, L0: FloatArray, V0: FloatArray) -> None:
    """Copy m impulses and all velocities to (L0, V0)."""
    for i in range(m):
        L0[i, 0] = L[i, 0]
        L0[i, 1] = L[i, 1]
    for i in range(len(V)):
        for c in range(3):
            V0[i, c] = V[i, c]
