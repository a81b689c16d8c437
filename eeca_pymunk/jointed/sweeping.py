"""Sweeps over contacts, and over bounded rows of joints, with the answers of components in the place of masses."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.contacts import Row
from ..rows.build import normal_rate, tangent_rate
from ..rows.sweeps import coulomb
from .bounded import Bounded, sweep_bounded
from .columns import Columns


@uncounted
def sweep_columns(
    C: Columns, D: Bounded, A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, m: int
) -> float:
    """One sweep over the m contacts as `..rows.sweeps.sweep`, and over the bounded rows, whose impulses are L[m:, 0];
    the largest change of a velocity."""
    worst = 0.0
    for i in range(m):
        if C.OUT[i] != 0:
            continue
        lam0, beta0 = L[i, 0], L[i, 1]
        lam, beta, ann = 0.0, 0.0, ROWS[i].a_nn
        short = normal_rate(A, B, ROWS, V, i) - ROWS[i].target
        if ROWS[i].wake < np.inf:
            if short + ROWS[i].target - lam0 * ann < ROWS[i].wake:
                ROWS[i].wake = np.inf
            else:
                short = np.inf
        if ROWS[i].friction <= 0.0:
            lam = max(lam0 - ROWS[i].k_n * short, 0.0)
        else:
            qn = short - lam0 * ann - beta0 * ROWS[i].a_nt
            # Where friction alone could part the surfaces, a_nn < mu |a_nt|, a contact may stick though it would open
            # without its impulses: then what has stuck goes on.
            if qn < 0.0 or lam0 > 0.0:
                ut = tangent_rate(A, B, ROWS, V, i)
                # Most stick, and need no more than this.
                lam = lam0 - (ROWS[i].w_nn * short + ROWS[i].w_nt * ut)
                beta = beta0 - (ROWS[i].w_nt * short + ROWS[i].w_tt * ut)
                sticks = abs(beta) <= ROWS[i].friction * lam and beta * ROWS[i].ut <= 0.0
                if not sticks and not qn < 0.0:
                    lam, beta = 0.0, 0.0
                elif not sticks:
                    ant, att = ROWS[i].a_nt, ROWS[i].a_tt
                    lam, beta = coulomb(
                        qn, ut - beta0 * att - lam0 * ant, ann, ant, att, ROWS[i].friction, ROWS[i].un, ROWS[i].ut,
                        ROWS[i].target,
                    )  # fmt: skip
        dn, dt = lam - lam0, beta - beta0
        if dn == 0.0 and dt == 0.0:
            continue
        L[i, 0], L[i, 1] = lam, beta
        for w in range(C.AT[i], C.AT[i + 1]):
            for c in range(3):
                V[C.BODY[w], c] += dn * C.N[w, c] + dt * C.T[w, c]
        worst = max(worst, abs(dn) * ann, abs(dt) * ROWS[i].a_tt)
    return max(worst, sweep_bounded(D, L, m, V))


@uncounted
def relax_columns(
    C: Columns, D: Bounded, A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, m: int,
    tolerance: float, most: int,
) -> tuple[int, float]:  # fmt: skip
    """Sweeps until one changes no contact's velocity by more than the tolerance; how many, and the last change."""
    done, worst = 0, np.inf
    while done < most and worst > tolerance:
        worst = sweep_columns(C, D, A, B, ROWS, L, V, m)
        done += 1
    return done, worst
