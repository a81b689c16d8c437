"""Arguments: checks of single numbers, whose errors name the argument, its value and what to give."""

from __future__ import annotations

import math
import operator


def check_count(name: str, value: int, least: int = 0, most: int | None = None) -> int:
    """A whole number from `least` to `most`; TypeError for what is no whole number, ValueError for others."""
    wanted = f"give a whole number >= {least}" if most is None else f"give a whole number from {least} to {most}"
    try:
        count = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} = {value!r}: {wanted}") from None
    if count < least or (most is not None and count > most):
        raise ValueError(f"{name} = {count}: {wanted}")
    return count


def check_finite(name: str, value: float, *, zero: bool = False, unit: str = "") -> float:
    """A finite number > 0, or >= 0 if `zero`, as a float; TypeError for what is no number, ValueError for others.
    `unit`: words for the message."""
    wanted = f"give a finite number {'>=' if zero else '>'} 0{unit and f', in {unit}'}"
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} = {value!r}: {wanted}") from None
    if not 0.0 <= number < math.inf or (number == 0.0 and not zero):
        raise ValueError(f"{name} = {value}: {wanted}")
    return number
