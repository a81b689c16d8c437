"""Pictures of single moments."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver
from PIL import Image

from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.files import whole_file
from eeca_pymunk.recording import Recording
from eeca_pymunk.report import StepReport
from eeca_pymunk.space.bodies import moving
from eeca_pymunk.space.outlines import Outlines

from .drawing import ARROW_COLOR, GHOST_COLOR, Drawing, bounds

if TYPE_CHECKING:
    import pymunk

View = tuple[float, float, float, float]
_COLORS = 128
ARROWS = ("velocity", "momentum")
_NO_LENGTH = 1e-200  # longest vector, if the longest one is none: scales of arrows would overflow
_LEAST = 0.1  # widths of its shaft: what is drawn of an arrow without length is a dot of this size


def figure(width: float, height: float, dpi: float = 110) -> Figure:
    """A figure of `width` x `height` inches that needs no display."""
    result = Figure(figsize=(width, height), dpi=dpi, layout="constrained")
    FigureCanvasAgg(result)
    return result


def snapshot(
    subject: pymunk.Space | Recording, ax: Axes | None = None, *, time: float = 0.0, path: str | Path | None = None,
    title: str = "", velocity: bool = False, momentum: bool = False, report: StepReport | None = None,
    view: View | None = None,
) -> Axes:  # fmt: skip
    """Draw the shapes of a space now, or of a recording at its moment nearest to `time`; disks to scale.

    Args:
        ax: where to draw; a new figure if None.
        path: save the figure there, format by suffix.
        velocity, momentum: an arrow for each moving body; momenta as in the paper's Figs. 8 and 9.
        report: of the step that led here: its contacts are drawn, each impulse as a pair of arrows along the normal.
        view: (left, right, bottom, top) lengths; all shapes if None.
    """
    check_view(view)
    check_picture(path)
    if isinstance(subject, Recording):
        i = moment(subject, time)
        outlines, mass = subject.outlines, subject.mass
        x, angle, v = subject.position[i], subject.angle[i], subject.velocity[i]
    else:
        bodies = moving(subject)
        outlines, mass = Outlines.of(subject, bodies), np.array([b.mass for b in bodies])
        x, v = (np.array(a, float).reshape(-1, 2) for a in ([b.position for b in bodies], [b.velocity for b in bodies]))
        angle = np.array([b.angle for b in bodies])
    box = bounds(outlines, x[None], angle[None]) if view is None else view
    ax = figure(5.0, 5.0).add_subplot() if ax is None else ax
    frame(ax, box, title)
    Drawing(ax, outlines).move(x, angle)
    if velocity or momentum:
        arrows(ax, x, momenta(v, mass) if momentum else v)
    if report is not None:
        _impulses(ax, report)
    if path is not None:
        root = ax.get_figure(root=True)
        assert isinstance(root, Figure)  # axes are on a figure
        save_picture(root, path)
    return ax


def strip(
    recording: Recording, times: Sequence[float], *, path: str | Path | None = None, title: str = "",
    velocity: bool = False, momentum: bool = False, view: View | None = None,
) -> Figure:  # fmt: skip
    """Several moments of a recording in a row, as in the paper's Fig. 12, with one scale; see `snapshot`."""
    if len(times) == 0:
        raise ValueError("times is empty: give one or more times to show")
    check_view(view)
    check_picture(path)
    shown = [moment(recording, t) for t in times]
    box = bounds(recording.outlines, recording.position[shown], recording.angle[shown]) if view is None else view
    row = figure(3.2 * len(times), 3.6)
    for ax, t, i in zip(np.atleast_1d(row.subplots(1, len(times))), times, shown, strict=True):
        label = f"{recording.time[i]:.4g} s"
        snapshot(recording, ax, time=t, title=label, velocity=velocity, momentum=momentum, view=box)
    row.suptitle(title)
    if path is not None:
        save_picture(row, path)
    return row


def save_picture(figure: Figure, path: str | Path) -> None:
    """Write a figure, whole or not at all; format by suffix. PNGs get a palette: a third of the size."""
    check_picture(path)
    with whole_file(path) as partial:
        figure.savefig(partial)
        if partial.suffix == ".png":
            with Image.open(partial) as full:
                small = full.convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE)
            small.save(partial, optimize=True)


def check_picture(path: str | Path | None) -> None:
    """ValueError if pictures cannot be written to files with this suffix."""
    known = sorted(FigureCanvasAgg.get_supported_filetypes())
    if path is not None and Path(path).suffix.lower()[1:] not in known:
        raise ValueError(f"path = {str(path)!r}: give a name that ends in one of .{', .'.join(known)}")


def check_view(view: View | None) -> None:
    """ValueError unless a view is None, or four finite numbers that enclose an area."""
    if view is None:
        return
    box = np.asarray(view, float)
    if box.shape != (4,) or not np.isfinite(box).all() or box[0] == box[1] or box[2] == box[3]:
        raise ValueError(f"view = {view}: give four finite numbers, left, right, bottom, top, that enclose an area")


def moment(recording: Recording, time: float) -> int:
    """The index of the moment nearest to `time`; ValueError if the recording does not reach it."""
    half = 0.5 * float(recording.time[1] - recording.time[0]) if len(recording) > 1 else 0.0
    if not recording.time[0] - half <= time <= recording.time[-1] + half:
        raise ValueError(f"time = {time}: the recording goes from {recording.time[0]} to {recording.time[-1]}")
    return int(np.argmin(np.abs(recording.time - time)))


def frame(ax: Axes, view: View, title: str) -> None:
    """Axes of equal scale that show `view`."""
    ax.set_aspect("equal")
    ax.set_xlim(view[0], view[1])
    ax.set_ylim(view[2], view[3])
    ax.set_title(title)


def arrows(ax: Axes, x: FloatArray, vector: FloatArray, longest: float | None = None) -> Quiver:
    """An arrow for each (N, 2) vector at (N, 2) positions. A vector of length `longest`, by default the longest one
    here, spans two fifths of the axes. Vectors of no length, and those that are not finite (the momentum of a
    kinematic body), have no arrow."""
    size = np.hypot(*vector.T)
    shown = np.where(np.isfinite(size)[:, None], vector, 0.0)
    length = float(np.hypot(*shown.T).max(initial=0.0)) if longest is None else longest
    return ax.quiver(
        x[:, 0], x[:, 1], shown[:, 0], shown[:, 1], color=ARROW_COLOR, width=0.006, scale=2.5 * _scale(length),
        scale_units="width", minlength=_LEAST, zorder=3,
    )  # fmt: skip


def momenta(velocity: FloatArray, mass: FloatArray) -> FloatArray:
    """(..., N, 2) momenta of bodies from velocities (..., N, 2) and masses (N,); 0 for infinite masses."""
    return velocity * np.where(np.isfinite(mass), mass, 0.0)[:, None]


def _scale(longest: float) -> float:
    """The length of the longest arrow, 1 if it has none."""
    return longest if longest > _NO_LENGTH else 1.0


def _impulses(ax: Axes, report: StepReport) -> None:
    """A pair of arrows along the normal of each contact that acted, their length by its impulse."""
    contacts, lam = report.contacts, report.impulse
    acted = lam > 0
    point, push = contacts.point[acted], (lam[:, None] * contacts.normal)[acted]
    scale = 5.0 * _scale(float(lam.max(initial=0.0)))
    for sign in (1.0, -1.0):
        ax.quiver(
            point[:, 0], point[:, 1], sign * push[:, 0], sign * push[:, 1],
            color=GHOST_COLOR, width=0.006, scale=scale, scale_units="width", zorder=5,
        )  # fmt: skip
    ax.plot(point[:, 0], point[:, 1], "k.", markersize=3, zorder=6)
