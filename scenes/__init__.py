"""The paper's problems, some with exact solutions, and demonstrations: `scenes.build(name, **parameters) -> Scene`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from . import (
    ball,
    balls_and_lines,
    billiard,
    breakout,
    carom,
    colours,
    cradle,
    drum,
    gas,
    hopper,
    lander,
    linked,
    mixed,
    pendulum,
    pile,
    pool_break,
    pyramid,
    rods,
    signorini,
    slope,
    walker,
)
from .scene import Scene

_BUILDERS: dict[str, Callable[..., Scene]] = {
    "signorini": signorini.build,
    "carom": carom.build,
    "cradle": cradle.build,
    "ball": ball.build,
    "gas": gas.build,
    "mixed": mixed.build,
    "pool_break": pool_break.build,
    "hopper": hopper.build,
    "breakout": breakout.build,
    "balls_and_lines": balls_and_lines.build,
    "colours": colours.build,
    "drum": drum.build,
    "slope": slope.build,
    "pyramid": pyramid.build,
    "pile": pile.build,
    "billiard": billiard.build,
    "pendulum": pendulum.build,
    "double_pendulum": linked.double_pendulum,
    "chain": linked.chain,
    "bridge": linked.bridge,
    "rods": rods.cradle,
    "heap": rods.heap,
    "lander": lander.build,
    "walker": walker.build,
}
NAMES = tuple(_BUILDERS)


def build(name: str, **parameters: Any) -> Scene:
    """Build a scene by name; ValueError for an unknown name or parameter value."""
    if name not in _BUILDERS:
        raise ValueError(f"unknown scene {name!r}: choose one of {', '.join(NAMES)}")
    return _BUILDERS[name](**parameters)


__all__ = ["NAMES", "Scene", "build"]
