"""Private names of pymunk's arbiters: their C structures, read and written; see `spaces`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import pymunk
from pymunk import batch
from pymunk._chipmunk_cffi import ffi, lib

from .batch import batched
from .versions import decide

OF_LIBRARY = (
    "pmSpaceArbiterIteratorFuncBatched", "cpBodyIsSleeping", "cpShapeGetCollisionType",
    "CP_ARBITER_STATE_FIRST_COLLISION",
)  # fmt: skip
TYPES = ("cpArbiter *", "cpContact[1]")


def shape_key(shape: pymunk.Shape) -> int:
    """The address of a shape in Chipmunk."""
    return int(ffi.cast("uintptr_t", shape._shape))


def arbiter_key(arbiter: Any) -> frozenset[int]:
    """The addresses of both shapes of an arbiter."""
    return frozenset((int(ffi.cast("uintptr_t", arbiter.a)), int(ffi.cast("uintptr_t", arbiter.b))))


def kinds(arbiter: Any) -> tuple[int, int]:
    """The collision types of both shapes of an arbiter."""
    return lib.cpShapeGetCollisionType(arbiter.a), lib.cpShapeGetCollisionType(arbiter.b)


def second_is(arbiter: Any, shape: pymunk.Shape) -> bool:
    """Whether a shape is the second one of an arbiter."""
    return int(ffi.cast("uintptr_t", arbiter.b)) == shape_key(shape)


def stamp(arbiter: pymunk.Arbiter) -> int:
    """The number of pymunk's step in which the shapes of an arbiter last touched."""
    return int(arbiter._arbiter.stamp)


def reject(arbiter: pymunk.Arbiter) -> None:
    """Make the collision of an arbiter whose shapes touch not take place, see `versions.decide`."""
    decide(arbiter._arbiter, False)


def asleep(arbiter: Any) -> bool:
    """Whether a body of an arbiter sleeps."""
    return bool(lib.cpBodyIsSleeping(arbiter.body_a) or lib.cpBodyIsSleeping(arbiter.body_b))


def set_impulse(arbiter: Any, impulse: tuple[float, float] | None) -> list[tuple[float, float]]:
    """Set the impulse of an arbiter on its second shape (mass length/time), in equal parts at its points, if it has
    any; None for 0. Returns the old normal and tangential impulse of each point, for `restore_impulse`."""
    old = [(arbiter.contacts[k].jnAcc, arbiter.contacts[k].jtAcc) for k in range(arbiter.count)]
    x, y = (0.0, 0.0) if impulse is None else impulse
    nx, ny = arbiter.n.x, arbiter.n.y
    for k in range(arbiter.count):
        arbiter.contacts[k].jnAcc = (x * nx + y * ny) / arbiter.count
        arbiter.contacts[k].jtAcc = (y * nx - x * ny) / arbiter.count
    return old


def restore_impulse(arbiter: Any, old: Sequence[tuple[float, float]]) -> None:
    """Undo `set_impulse`."""
    for k, (normal, tangential) in enumerate(old):
        arbiter.contacts[k].jnAcc, arbiter.contacts[k].jtAcc = normal, tangential


def _centre(shape: pymunk.Shape) -> tuple[float, float, float, float]:
    """Centre of mass of the shape's body (x, y), its inverse mass and inverse moment; 0 unless it is dynamic."""
    body = shape.body
    assert body is not None
    x, y = body.local_to_world(body.center_of_gravity)
    if body.body_type != pymunk.Body.DYNAMIC:
        return x, y, 0.0, 0.0
    return x, y, 1.0 / body.mass, 1.0 / body.moment


def make_arbiter(
    a: pymunk.Shape, b: pymunk.Shape, normal: tuple[float, float], points: Sequence[tuple[float, float]],
    impulse: tuple[float, float],
) -> Any:  # fmt: skip
    """An arbiter, in no space, of two shapes that touched at these points (1 or 2) with this impulse on b.

    The normal is a unit vector from a to b. `nMass` and `tMass` are the effective masses of a point along the normal
    and the tangent; infinite if no body is dynamic any more, so that no energy was lost.
    """
    nx, ny = normal
    contacts, arbiter = ffi.new("cpContact[]", len(points)), ffi.new("cpArbiter *")
    (xa, ya, ma, ia), (xb, yb, mb, ib) = _centre(a), _centre(b)
    for contact, (px, py) in zip(contacts, points, strict=True):
        contact.r1.x, contact.r1.y, contact.r2.x, contact.r2.y = px - xa, py - ya, px - xb, py - yb
        # Arms of the normal and of the tangential impulse.
        n_arm_a, n_arm_b = (px - xa) * ny - (py - ya) * nx, (px - xb) * ny - (py - yb) * nx
        t_arm_a, t_arm_b = (px - xa) * nx + (py - ya) * ny, (px - xb) * nx + (py - yb) * ny
        moves = ma + mb > 0.0
        contact.nMass = 1.0 / (ma + mb + ia * n_arm_a * n_arm_a + ib * n_arm_b * n_arm_b) if moves else math.inf
        contact.tMass = 1.0 / (ma + mb + ia * t_arm_a * t_arm_a + ib * t_arm_b * t_arm_b) if moves else math.inf
    body_a, body_b = a.body, b.body
    assert body_a is not None
    assert body_b is not None
    arbiter.a, arbiter.b, arbiter.body_a, arbiter.body_b = a._shape, b._shape, body_a._body, body_b._body
    arbiter.e, arbiter.u = a.elasticity * b.elasticity, a.friction * b.friction
    arbiter.n.x, arbiter.n.y, arbiter.count, arbiter.contacts = nx, ny, len(points), contacts
    arbiter.state = lib.CP_ARBITER_STATE_FIRST_COLLISION
    decide(arbiter, True)
    set_impulse(arbiter, impulse)
    return ffi.gc(arbiter, lambda _: contacts)  # keeps the contacts as long as the arbiter exists


def turn_to(arbiter: Any, body: pymunk.Body) -> None:
    """Order the shapes of an arbiter so that the first one belongs to `body`."""
    arbiter.swapped = 1 if arbiter.body_b == body._body else 0


def raw(arbiter: pymunk.Arbiter) -> Any:
    """Pointer to an arbiter of Chipmunk."""
    return arbiter._arbiter


def batch_arbiters(arbiters: Sequence[Any], fields: batch.ArbiterFields, buffers: batch.Buffer) -> None:
    """Append arbiters to the buffers of `batch.get_space_arbiters`."""
    data = batched(fields, buffers._float_arr, buffers._int_arr)
    for arbiter in arbiters:
        lib.pmSpaceArbiterIteratorFuncBatched(arbiter, data)
