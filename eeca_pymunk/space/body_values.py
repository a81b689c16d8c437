"""Values of bodies that are read once: mass, moment, centre of gravity, kind; as the bytes of a `BodyValues`."""

from __future__ import annotations

import math
import struct
from typing import Any

import pymunk

from ..compiled.records import packer
from ..model.values import DYNAMIC, KINEMATIC, STATIC, BodyValues
from .private import spaces as private

_KIND = {pymunk.Body.DYNAMIC: DYNAMIC, pymunk.Body.KINEMATIC: KINEMATIC, pymunk.Body.STATIC: STATIC}
_VALUES = packer(BodyValues)
_AT: Any = BodyValues.TYPE.fields
# In the bytes mass, moment and their inverses are [_FROM:_TO], the centre of gravity [_TO:_CENTRE], and the kind
# [:_KIND_END].
_KIND_END, _FROM, _TO, _CENTRE = (_AT[name][1] for name in ("place", "mass", "centre_x", "x"))
_MASSES = struct.Struct("4d")
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
    return _VALUES.pack(kind, 0, steered, moved, *masses, x, y, 0.0, 0.0, 0.0, -1, 0, 0)


def masses(values: bytes) -> tuple[float, ...]:
    """Mass, moment and their inverses."""
    return _MASSES.unpack_from(values, _FROM)


def others(values: bytes) -> bytes:
    """All values but those of `masses`."""
    return values[:_FROM] + values[_TO:]


def centre(values: bytes) -> bytes:
    """Kind and centre of gravity, for comparison."""
    return values[:_KIND_END] + values[_TO:_CENTRE]
