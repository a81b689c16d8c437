"""Shapes: arrays of a space's shapes, and the refusal of what the steppers do not model."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymunk

from .bodies import Bodies, BoolArray, FloatArray, IntArray
from .errors import UnsupportedFeature


class Walls:
    """Static convex outlines, as padded arrays of edges in world coordinates; a segment is an outline of two edges.

    Outlines with fewer edges than the widest one repeat their first edge, which changes no distance.

    Attributes:
        start, edge, outward: (W, k, 2) first vertex, edge vector (length) and outward unit normal of every edge.
        length_squared: (W, k) length².  The same, prefixed `flat_`, as (W k,) edges.
    """

    def __init__(self, outlines: list[FloatArray]) -> None:
        width = max((len(o) for o in outlines), default=1)
        start = np.zeros((len(outlines), width, 2))
        end = np.zeros_like(start)
        for i, outline in enumerate(outlines):
            start[i], end[i] = outline[0], outline[1]
            start[i, : len(outline)], end[i, : len(outline)] = outline, np.roll(outline, -1, axis=0)
        self.start: FloatArray = start
        self.edge: FloatArray = end - start
        self.length_squared: FloatArray = np.maximum(np.sum(self.edge**2, axis=2), np.finfo(float).tiny)
        length = np.sqrt(self.length_squared)[..., None]
        # Counter-clockwise outlines (pymunk's hulls) have their outside on the right of every edge.
        self.outward: FloatArray = np.stack((self.edge[..., 1], -self.edge[..., 0]), axis=2) / length
        self.flat_start, self.flat_edge, self.flat_outward = (
            x.reshape(-1, 2) for x in (self.start, self.edge, self.outward)
        )
        self.flat_length_squared = self.length_squared.ravel()


class Shapes:
    """The solid shapes of a space, one index each: moving disks and static walls.

    Attributes:
        items: the pymunk shapes, by index.
        row: (S,) the row of the shape's body in `Bodies`.
        radius: (S,) length; the rounding radius of a segment or polygon.
        elasticity: (S,).  lossy: whether any is below 1.  wall: (S,) index into `walls`, -1 for a disk.
    """

    def __init__(self, space: pymunk.Space, bodies: Bodies) -> None:
        self.key: list[pymunk.Shape] = list(space.shapes)
        self.items: list[pymunk.Shape] = [s for s in self.key if not s.sensor]
        check_bodies(bodies, self.items)
        for shape in self.items:
            check_shape(shape, bodies)
        check_friction(self.items)
        owners = [shape_body(s) for s in self.items]
        self.row: IntArray = np.array([bodies.row[b] for b in owners], np.intp)
        # Every kind of pymunk shape has a radius.
        self.radius: FloatArray = np.array([_radius(s) for s in self.items], float)
        self.elasticity: FloatArray = np.array([s.elasticity for s in self.items], float)
        outlines: list[FloatArray] = []
        self.wall: IntArray = np.full(len(self.items), -1, np.intp)
        for i, (shape, owner) in enumerate(zip(self.items, owners, strict=True)):
            if not bodies.dynamic[self.row[i]]:
                self.wall[i] = len(outlines)
                outlines.append(_outline(shape, owner))
        self.walls = Walls(outlines)
        self.is_disk: BoolArray = self.wall < 0
        self.lossy = bool((self.elasticity < 1.0).any())

    def __len__(self) -> int:
        return len(self.items)


def shape_body(shape: pymunk.Shape) -> pymunk.Body:
    """The body of a shape; ValueError if it has none."""
    if shape.body is None:
        raise ValueError(f"{shape} has no body: create it with its body, or remove it from the space")
    return shape.body


def _radius(shape: Any) -> float:
    return float(shape.radius)


def local_outline(shape: pymunk.Shape) -> FloatArray:
    """(k, 2) vertices in body coordinates, counter-clockwise: k = 1 for a circle's centre, 2 for a segment's ends."""
    if isinstance(shape, pymunk.Circle):
        vertices = [shape.offset]
    elif isinstance(shape, pymunk.Segment):
        vertices = [shape.a, shape.b]
    elif isinstance(shape, pymunk.Poly):
        vertices = list(shape.get_vertices())
    else:
        raise UnsupportedFeature(f"{shape}: only circles, segments and polygons are known")
    return np.array(vertices, float)


def _outline(shape: pymunk.Shape, owner: pymunk.Body) -> FloatArray:
    """(k, 2) world vertices of at least two; a circle is its centre twice."""
    local = local_outline(shape)
    local = np.repeat(local, 2, axis=0) if len(local) == 1 else local
    return np.array([owner.local_to_world((float(x), float(y))) for x, y in local], float)


def check_space(space: pymunk.Space) -> None:
    """Refuse settings and objects of the space that the array steppers do not model."""
    if space.constraints:
        raise UnsupportedFeature(
            f"{next(iter(space.constraints))}: constraints are not modelled; remove it or use ep.Native(space)"
        )
    if space.damping != 1.0:
        raise UnsupportedFeature(f"space.damping = {space.damping} is not modelled; set it to 1 or use ep.Native")
    if space.sleep_time_threshold != math.inf:
        raise UnsupportedFeature(
            f"space.sleep_time_threshold = {space.sleep_time_threshold}: sleeping is not modelled; set it to math.inf"
        )
    # pymunk offers no public way to ask for the handlers of a space.
    if space._handlers:
        raise UnsupportedFeature(
            f"space.on_collision handlers for collision types {list(space._handlers)} are not called yet; "
            "use ep.Native(space) for a scene that needs them"
        )
    if not all(math.isfinite(g) for g in space.gravity):
        raise ValueError(f"space.gravity = {space.gravity}: set a finite gravity before stepping")


def check_bodies(bodies: Bodies, shapes: list[pymunk.Shape]) -> None:
    """Refuse user functions, off-centre centres of gravity, and kinematic bodies with shapes."""
    owners = {s.body for s in shapes}
    for i, body in enumerate(bodies.items):
        # The public properties return bound C wrappers when unset; the private slots tell whether a user set them.
        if body._velocity_func is not None or body._position_func is not None:
            raise UnsupportedFeature(f"{body} has a velocity_func or position_func of its own, which is not called yet")
        if body not in owners:
            continue
        if body.body_type == pymunk.Body.KINEMATIC:
            raise UnsupportedFeature(
                f"{body} is kinematic and has shapes: moving walls are not modelled yet; make it static or dynamic"
            )
        if bodies.dynamic[i] and bodies.center_of_gravity[i].any():
            raise UnsupportedFeature(
                f"{body} has its centre of gravity at {body.center_of_gravity}: only (0, 0) is modelled yet"
            )


def check_shape(shape: pymunk.Shape, bodies: Bodies) -> None:
    """Refuse moving shapes other than centred disks, and surface velocity."""
    body = shape_body(shape)
    if any(shape.surface_velocity):
        raise UnsupportedFeature(f"{shape} has surface velocity {shape.surface_velocity}; set it to (0, 0)")
    if not isinstance(shape, (pymunk.Circle, pymunk.Segment, pymunk.Poly)):
        raise UnsupportedFeature(f"{shape} is neither a Circle, a Segment nor a Poly; replace it by one of them")
    if not 0.0 <= shape.elasticity <= 1.0:
        raise ValueError(f"{shape} has elasticity {shape.elasticity}: set a value from 0 to 1")
    if not math.isfinite(_radius(shape)):
        raise ValueError(f"{shape} has radius {_radius(shape)}: set a finite radius")
    if body not in bodies.row:
        raise ValueError(f"the body of {shape} is not in the space; add it with space.add(body)")
    if bodies.dynamic[bodies.row[body]]:
        if not isinstance(shape, pymunk.Circle):
            raise UnsupportedFeature(f"{shape} on the dynamic {body}: only disks move yet; use pymunk.Circle")
        if any(shape.offset):
            raise UnsupportedFeature(f"{shape} has offset {shape.offset} from the centre of {body}: only (0, 0) yet")


def check_friction(shapes: list[pymunk.Shape]) -> None:
    """Refuse friction > 0 on a moving shape and on some shape of another body (pymunk multiplies the two)."""
    rough = [s for s in shapes if s.friction > 0]
    for shape in rough:
        body = shape_body(shape)
        if body.body_type == pymunk.Body.DYNAMIC and any(other.body is not body for other in rough):
            raise UnsupportedFeature(
                f"{shape} has friction {shape.friction}, and so has a shape it may touch: friction is not modelled; "
                "set shape.friction = 0"
            )
