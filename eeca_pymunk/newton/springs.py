"""The law of springs: a force linear in length or angle, capped at max_force; its mean over a step, its potential.

With f(x) = push + slope (x - rest), slope = -k of springs and +k of rotary ones, capped at +-bound, the mean of f over
[x0, x1] is (Psi(f1) - Psi(f0)) / (f1 - f0), Psi the integral of the cap; the step's work is then exactly what the
potential Psi(f)/|slope| gives or takes. A `force_func` of the user is entered as such a law that has its mean over the
step (`..space.spring_functions`).
"""

from __future__ import annotations

from ..compiled import nonallocating


@nonallocating
def cap_integral(f: float, bound: float) -> float:
    """The integral Psi from 0 to f of a force capped at +-bound."""
    if abs(f) <= bound:
        return 0.5 * f * f
    return bound * (abs(f) - 0.5 * bound)


@nonallocating
def mean_force(push: float, slope: float, bound: float, began: float, ended: float) -> float:
    """The mean over [began, ended], relative to the rest position, of push + slope x, capped: a force or torque."""
    f0, f1 = push + slope * began, push + slope * ended
    if abs(f0) <= bound and abs(f1) <= bound:
        return 0.5 * (f0 + f1)
    if abs(f1 - f0) <= 1e-7 * bound:
        return max(-bound, min(bound, 0.5 * (f0 + f1)))
    return (cap_integral(f1, bound) - cap_integral(f0, bound)) / (f1 - f0)


@nonallocating
def potential(push: float, slope: float, bound: float, at: float) -> float:
    """Potential energy of that law with slope <= 0, at a length or angle relative to rest: Psi(f)/|slope|, or -f x of a
    constant force f. A rotary spring, of slope > 0, is one of slope -k in the angle with the other sign."""
    if slope == 0.0:
        return -max(-bound, min(bound, push)) * at
    return cap_integral(push + slope * at, bound) / -slope
