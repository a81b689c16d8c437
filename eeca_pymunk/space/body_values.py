"""Values of bodies that are read once: mass, moment, centre of gravity, kind; as the bytes of a `BodyValues`."""

from __future__ import annotations

import math
import struct

import pymunk

from ..model.values import DYNAMIC, KINEMATIC, STATIC
from .private import spaces as private

_KIND = {pymunk.Body.DYNAMIC: DYNAMIC, pymunk.Body.KINEMATIC: KINEMATIC, pymunk.Body.STATIC: STATIC}
_VALUES = struct.Struct("4q9d2q")  # a `BodyValues`
# Mass, moment and their inverses; in the bytes they are [_FROM:_TO], the centre of gravity [_TO:_CENTRE], and the kind
# [:_KIND_END].
_MASSES, _KIND_END, _FROM, _TO, _CENTRE = struct.Struct("4d"), 8, 32, 64, 80
FIXED = math.inf, math.inf, 0.0, 0.0  # those of static, kinematic and sleeping bodies


def read(body: pymunk.Body) -> bytes:
    """The values of a body.

    Raises:
        ValueError: for a dynamic body whose mass or moment is not positive, or whose mass is not finite.
    """
    native, mass, moment, x, y, steered, moved = private.body_values(body)
    kind, masses = _KIND[native], FIXED
    if kind == DYNAMIC:
        if not (0.0 < mass < math.inf and moment > 0.0):
            raise ValueError(
                f"{body} has mass {mass} and moment {moment}: a dynamic body needs a finite mass > 0 and a moment > 0; "
                "set body.mass and body.moment, or the mass or density of its shapes"
            )
        masses = mass, moment, 1.0 / mass, 1.0 / moment
    return _VALUES.pack(kind, 0, steered, moved, *masses, x, y, 0.0, 0.0, 0.0, -1, 0)


def masses(values: bytes) -> tuple[float, ...]:
    """Mass, moment and their inverses."""
    return _MASSES.unpack_from(values, _FROM)


def others(values: bytes) -> bytes:
    """All values but those of `masses`."""
    return values[:_FROM] + values[_TO:]


def centre(values: bytes) -> bytes:
    """Kind and centre of gravity, for comparison."""
    return values[:_KIND_END] + values[_TO:_CENTRE]
