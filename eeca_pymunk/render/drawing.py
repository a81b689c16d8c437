"""Drawing: the shapes of a space on axes; artists are made once and moved."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection, EllipseCollection, LineCollection, PolyCollection

from eeca_pymunk.arrays import FloatArray, IntArray
from eeca_pymunk.space.outlines import Outlines, to_world

# From the colour-blind safe set of Okabe and Ito; they differ in lightness too.
MOVING_COLOR, STATIC_COLOR, SENSOR_COLOR = "#0072b2", "#444444", "#cc79a7"
ARROW_COLOR, GHOST_COLOR = "#d55e00", "#e69f00"
COLORS = (MOVING_COLOR, STATIC_COLOR, SENSOR_COLOR, ARROW_COLOR, GHOST_COLOR)
_POINT = 1e-9  # of the distance from the origin: largest size of what is drawn as a point
_ARC = 7  # points of the rounding of a corner


class Drawing:
    """Collections of disks, lines and polygons; `move` puts them where the bodies are.

    Those of static shapes are final at once; `artists` lists the others. `ghost`: outlines only.
    """

    def __init__(self, ax: Axes, outlines: Outlines, *, ghost: bool = False) -> None:
        self._moving: list[_Part] = []
        first = np.cumsum(outlines.count) - outlines.count
        vertices = [outlines.vertex[i : i + k] for i, k in zip(first, outlines.count, strict=True)]
        disk = outlines.count == 1
        line = (outlines.count == 2) & (outlines.radius == 0)
        for still in (False,) if ghost else (True, False):
            for sensor in (True, False):
                here = ((outlines.row < 0) == still) & (outlines.sensor == sensor)
                color = SENSOR_COLOR if sensor else STATIC_COLOR if still else MOVING_COLOR
                for which in (disk, line, ~disk & ~line):
                    chosen = np.flatnonzero(here & which)
                    if len(chosen) == 0:
                        continue
                    local = [vertices[i] for i in chosen]
                    artist, local = _artist(ax, outlines.radius[chosen], local, color, ghost)
                    ax.add_collection(artist, autolim=False)
                    part = _Part(artist, local, outlines.row[chosen])
                    if still:
                        part.draw(part.local)
                    else:
                        self._moving.append(part)

    @property
    def artists(self) -> list[Artist]:
        return [part.artist for part in self._moving]

    def move(self, position: FloatArray, angle: FloatArray) -> None:
        """Draw the bodies at (N, 2) positions and (N,) angles; NaN leaves a body out."""
        for part in self._moving:
            part.draw(to_world(part.local, part.owner, position, angle))


class _Part:
    """One collection: points `local` of bodies `owner`, and how they become what is drawn."""

    def __init__(self, artist: Collection, local: list[FloatArray], row: IntArray) -> None:
        self.artist, self.local = artist, np.concatenate(local)
        lengths = [len(v) for v in local]
        self.owner = np.repeat(row, lengths)
        self.ends = np.cumsum(lengths)[:-1]

    def draw(self, world: FloatArray) -> None:
        if isinstance(self.artist, EllipseCollection):
            self.artist.set_offsets(world)
        else:
            self.artist.set_verts(np.split(world, self.ends))  # type: ignore[attr-defined]


def _artist(
    ax: Axes, radius: FloatArray, local: list[FloatArray], color: str, ghost: bool
) -> tuple[Collection, list[FloatArray]]:  # fmt: skip
    """The collection of shapes of one kind, and the points of each: disks, segments without width, or polygons."""
    face, edge = "none" if ghost else color, GHOST_COLOR if ghost else "none"
    if len(local[0]) == 1:
        return EllipseCollection(
            2.0 * radius, 2.0 * radius, np.zeros(len(radius)), units="xy", offsets=np.zeros((len(radius), 2)),
            offset_transform=ax.transData, facecolors=face, edgecolors=edge, linewidths=1.5 if ghost else 0.0,
            zorder=4 if ghost else 2,
        ), local  # fmt: skip
    if len(local[0]) == 2 and radius[0] == 0.0:
        return LineCollection([], colors=GHOST_COLOR if ghost else color, linewidths=1.5), local
    rounded = [_rounded(v, float(r)) for v, r in zip(local, radius, strict=True)]
    return PolyCollection([], facecolors=face, edgecolors=GHOST_COLOR if ghost else "white", linewidths=0.5), rounded


def _rounded(vertices: FloatArray, radius: float) -> FloatArray:
    """(k, 2) the boundary of the convex hull of counter-clockwise vertices, rounded by arcs at the corners."""
    if radius == 0.0:
        return vertices
    edge = np.roll(vertices, -1, axis=0) - vertices
    after = np.arctan2(-edge[:, 0], edge[:, 1])  # direction of the outward normal of the edge that leaves a corner
    before = np.roll(after, 1)
    turn = np.mod(after - before, 2.0 * np.pi)
    angle = before[:, None] + turn[:, None] * np.linspace(0.0, 1.0, _ARC)
    corner = vertices[:, None] + radius * np.stack((np.cos(angle), np.sin(angle)), axis=2)
    return corner.reshape(-1, 2)


def bounds(outlines: Outlines, position: FloatArray, angle: FloatArray) -> tuple[float, float, float, float]:
    """(left, right, bottom, top) of all shapes with the bodies at (T, N, 2) positions and (T, N) angles; NaN leaves a
    body out. ValueError if no shape is left."""
    if len(outlines) == 0:
        raise ValueError("there are no shapes to draw: the space, or the recording, has none")
    radius = np.repeat(outlines.radius, outlines.count)[:, None]
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for x, a in zip(position, angle, strict=True):
        world = outlines.place(x, a)
        here = np.isfinite(world).all(axis=1)
        low = np.minimum(low, (world - radius)[here].min(axis=0, initial=np.inf))
        high = np.maximum(high, (world + radius)[here].max(axis=0, initial=-np.inf))
    size, far = float(np.max(high - low)), float(np.max(np.maximum(np.abs(low), np.abs(high))))
    if size < 0.0:
        raise ValueError("no shape is there at these moments, all bodies were removed: give others, or a view")
    # Nothing but a point has no size: any scale shows it.
    pad = 0.03 * size if size > _POINT * far else max(1.0, 2.0 * _POINT * far)
    return float(low[0]) - pad, float(high[0]) + pad, float(low[1]) - pad, float(high[1]) + pad
