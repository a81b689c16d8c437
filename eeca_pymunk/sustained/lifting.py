"""Lifting bodies out of each other at the end of a span, paid from the losses of the same island and span.

delta = M^-1 G^T mu with 0 <= mu _|_ g + A mu >= 0 for the gaps g at the end, scaled so that the potential energy it
costs is at most the losses: no energy comes from push-out. Gaps above -1e-9 of the size are left alone.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..rows.build import normal_rate
from ..rows.energy import lift
from ..rows.layout import GAP, UN
from .ledger import against

_DEEP = 1e-9  # overlap relative to the size that is left alone


@kernel
def lifting(
    A: IntArray, B: IntArray, ROWS: FloatArray, VN: FloatArray, ACC: FloatArray, IM: FloatArray, II: FloatArray, n: int,
    m: int, h: float, size: float, budget: float, D: FloatArray,
) -> tuple[float, float]:  # fmt: skip
    """D (k, 3) = displacements to add at the end of the span.

    Args:
        VN: (k, 3) velocities at the end.  size: length.  budget: energy that may be spent.
    Returns:
        The work spent (<= budget), and the deepest gap before (length, negative in overlap).
    """
    D[:] = 0.0
    GAPS = np.empty(m)
    deepest = 0.0
    for i in range(m):
        GAPS[i] = ROWS[i, GAP] + 0.5 * h * (ROWS[i, UN] + normal_rate(A, B, ROWS, VN, i))
        deepest = min(deepest, GAPS[i])
    if deepest >= -_DEEP * size or not budget > 0.0:
        return 0.0, deepest
    lift(A, B, ROWS, GAPS, np.zeros(m), D, IM, II, m, 0.1 * _DEEP * size, 20 + 4000 // m)
    work = -against(ACC, IM, II, n, D)
    if work > budget:
        part = budget / work
        D *= part
        work *= part
    return work, deepest
