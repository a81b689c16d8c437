"""Value, kind, scale and effect of a parameter."""

from __future__ import annotations

from typing import NamedTuple, TypeVar

T = TypeVar("T", int, float)


class Parameter(NamedTuple):
    """One number that results or costs depend on.

    kind: "round-off" (a multiple of the error of floating-point arithmetic), "accuracy" (a chosen tolerance), "work" (a
    budget or crossover, which changes costs, and results within tolerances), "heuristic" (changes the motion).
    scale: the quantity that the value is relative to, or its unit. |a| is `Step.pulled`, the largest acceleration of a
    body, of the contacts of an island the largest one of its points (`..contacts`); the size of a shape its
    `Shape.extent`, that of a component the length that `..joints` measures, a width `geometry.widths.half_width`.
    effect: what the parameter decides.
    """

    value: float
    kind: str
    scale: str
    effect: str


DECLARED: list[Parameter] = []  # in the order of the modules that declare them


def _declare(value: T, kind: str, scale: str, effect: str) -> T:
    DECLARED.append(Parameter(value, kind, scale, effect))
    return value


def round_off(value: T, scale: str, effect: str) -> T:
    """Declare a multiple of round-off."""
    return _declare(value, "round-off", scale, effect)


def accuracy(value: T, scale: str, effect: str) -> T:
    """Declare a tolerance."""
    return _declare(value, "accuracy", scale, effect)


def work(value: T, scale: str, effect: str) -> T:
    """Declare a budget, or a size from which another method is cheaper."""
    return _declare(value, "work", scale, effect)


def heuristic(value: T, scale: str, effect: str) -> T:
    """Declare a number that changes the motion and follows from measurements alone."""
    return _declare(value, "heuristic", scale, effect)
