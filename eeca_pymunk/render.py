"""Pictures, headless: matplotlib's Agg canvas, never a display. The only importer of matplotlib."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pymunk
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection
from matplotlib.figure import Figure

MOVING, STATIC, ARROW = "#0072b2", "#444444", "#d55e00"  # from the colour-blind safe set of Okabe and Ito


def figure(width: float, height: float) -> Figure:
    """A figure of `width` x `height` inches that needs no display."""
    result = Figure(figsize=(width, height), dpi=110, layout="constrained")
    FigureCanvasAgg(result)
    return result


def snapshot(
    space: pymunk.Space,
    ax: Axes | None = None,
    *,
    path: str | Path | None = None,
    title: str = "",
    momentum: bool = False,
    view: tuple[float, float, float, float] | None = None,
) -> Axes:
    """Draw the shapes of a space now, disks to scale.

    Args:
        ax: where to draw; a new figure if None.  path: save the figure there, format by suffix.
        momentum: draw each body's linear momentum as an arrow, as in the paper's Figs. 8 and 9.
        view: (left, right, bottom, top) lengths; all shapes if None.
    """
    ax = figure(5.0, 5.0).add_subplot() if ax is None else ax
    disks: list[pymunk.Circle] = []
    lines, polygons = [], []
    for shape in space.shapes:
        owner = shape.body
        if owner is None:
            continue
        if isinstance(shape, pymunk.Circle):
            disks.append(shape)
        elif isinstance(shape, pymunk.Segment):
            lines.append([owner.local_to_world(shape.a), owner.local_to_world(shape.b)])
        elif isinstance(shape, pymunk.Poly):
            polygons.append([owner.local_to_world(v) for v in shape.get_vertices()])
    if disks:
        centers = np.array([d.body.local_to_world(d.offset) for d in disks if d.body is not None])
        widths = np.array([2 * d.radius for d in disks])
        ax.add_collection(
            EllipseCollection(
                widths,
                widths,
                np.zeros(len(disks)),
                units="xy",
                offsets=centers,
                offset_transform=ax.transData,
                facecolors=MOVING,
                edgecolors="none",
            )
        )
        ax.update_datalim(np.concatenate((centers - widths[:, None] / 2, centers + widths[:, None] / 2)))
    ax.add_collection(LineCollection(lines, colors=STATIC, linewidths=1.5))
    ax.add_collection(PolyCollection(polygons, facecolors=STATIC))
    if momentum:
        moving = [b for b in space.bodies if b.body_type == pymunk.Body.DYNAMIC]
        x, p = np.array([b.position for b in moving]), np.array([b.mass * b.velocity for b in moving])
        # The longest arrow spans two fifths of the axes, whatever the momenta.
        scale = 2.5 * max(float(np.linalg.norm(p, axis=1).max(initial=0.0)), np.finfo(float).tiny)
        ax.quiver(
            x[:, 0], x[:, 1], p[:, 0], p[:, 1], color=ARROW, width=0.006, scale=scale, scale_units="width", zorder=3
        )
    ax.set_aspect("equal")
    if view is None:
        ax.autoscale_view()
    else:
        ax.set_xlim(view[0], view[1])
        ax.set_ylim(view[2], view[3])
    ax.set_title(title)
    if path is not None:
        ax.get_figure(root=True).savefig(path)  # type: ignore[union-attr]
    return ax
