"""Films: recordings side by side at equal times, with traces of energy and momentum, or of the ledger."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import cast

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.lines import Line2D
from matplotlib.quiver import Quiver
from tqdm import tqdm

from eeca_pymunk.arguments import check_count, check_finite
from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.files import check_writable, whole_file
from eeca_pymunk.recording import Recording

from .drawing import MOVING_COLOR, Drawing, bounds
from .encode import check_fps, encoder, html_player
from .pictures import ARROWS, View, arrows, check_view, figure, frame, momenta
from .traces import FONT, Trace, readable, trace

Image = npt.NDArray[np.uint8]  # (height, width, 3)
Exact = Callable[[float], FloatArray | None]
_MOST = 4  # panels
_ABREAST = 3  # panels in one row; more are shown in two rows
_LEAST_PIXELS, _PIXELS = 16, 1 << 16  # of a frame's height and width, which matplotlib can draw
_PREVIEW = 60  # frames of a notebook's player
_TRAILED = 5  # number of bodies up to which paths are drawn


def animate(
    recordings: Recording | Sequence[Recording], path: str | Path, fps: float = 30, *,
    titles: Sequence[str] | None = None, exact: Exact | None = None, view: View | None = None,
    frames: int | None = None, arrow: str | None = None, dpi: float = 100, progress: bool = False,
) -> Path:  # fmt: skip
    """Write a film of one to three recordings side by side, or four in two rows; `.gif`, `.mp4` or `.html` by suffix.

    All panels have the same scale; a frame shows the moment of each recording that is nearest to its time. Below each
    panel are the energy relative to the start and the size of the momentum relative to its largest, or, if the ledger
    has losses or external work, a stack of energies and losses (`traces.py`).

    Args:
        recordings: one to four.
        titles: of the panels; stepper and dt if None.
        fps: frames per second, .002 to 1000; delays of a GIF are multiples of 10 ms.
        exact: function of time that returns the (N, 2) exact positions, None where unknown (`Scene.exact`): drawn as
            outlines.
        view: (left, right, bottom, top) lengths; by default all shapes at all moments of all recordings.
        frames: number of frames, evenly spaced in time; by default the largest number of moments.
        arrow: "velocity" or "momentum" of every body.
        dpi: dots per inch, > 0; a panel is 4 inches wide.
        progress: show a progress bar.

    Raises ValueError, TypeError or OSError, before anything is drawn, for bad arguments, a path that cannot be written,
    or an MP4 without ffmpeg (`pip install eeca-pymunk[video]`). The file is whole or absent.
    """
    path = Path(path)
    encode = encoder(path.suffix)
    fps = check_fps(fps)
    film = Film(recordings, titles=titles, exact=exact, view=view, frames=frames, arrow=arrow, dpi=dpi)
    check_writable(path)
    shots = tqdm(film.images(), desc=path.name, unit="frame", total=len(film), disable=not progress)
    with whole_file(path) as partial:
        encode(shots, partial, fps)
    return path


def player(recording: Recording, fps: float = 20) -> str:
    """Self-contained HTML of a small player of the recording."""
    fps = check_fps(fps)
    film = Film(recording, frames=min(len(recording), _PREVIEW), dpi=60)
    name = html.escape(str(recording.parameters.get("stepper", "recording")))
    return html_player(film.images(), fps, f"{name}, {len(recording)} frames")


class Film:
    """The frames of a film; `images` yields them. Artists are made once and moved."""

    def __init__(
        self, recordings: Recording | Sequence[Recording], *, titles: Sequence[str] | None = None,
        exact: Exact | None = None, view: View | None = None, frames: int | None = None, arrow: str | None = None,
        dpi: float = 100,
    ) -> None:  # fmt: skip
        shown = [recordings] if isinstance(recordings, Recording) else list(recordings)
        if not 1 <= len(shown) <= _MOST:
            raise ValueError(f"{len(shown)} recordings: give one to {_MOST}")
        titles = [_title(r) for r in shown] if titles is None else list(titles)
        if len(titles) != len(shown):
            raise ValueError(f"{len(titles)} titles for {len(shown)} recordings: give one for each")
        if frames is not None:
            frames = check_count("frames", frames, 1)
        dpi = check_finite("dpi", dpi)
        check_view(view)
        if arrow not in (None, *ARROWS):
            raise ValueError(f"arrow = {arrow!r}: choose one of {', '.join(ARROWS)}, or None")
        if view is None:
            boxes = np.array([bounds(r.outlines, r.position, r.angle) for r in shown])
            low, high = boxes.min(axis=0), boxes.max(axis=0)
            view = (float(low[0]), float(high[1]), float(low[2]), float(high[3]))
        end = max(float(r.time[-1]) for r in shown)
        self.times = np.linspace(0.0, end, max(len(r) for r in shown) if frames is None else frames)
        # Digits that resolve a hundredth of the film; their fixed number keeps the text in place.
        self.digits = min(max(2 - math.floor(math.log10(end)), 0), 9) if end > 0.0 else 0
        # Even numbers of pixels, which video codecs require.
        tall = min(max(4.0 * abs((view[3] - view[2]) / (view[1] - view[0])), 2.0), 8.0) + 1.9
        rows = 1 if len(shown) <= _ABREAST else 2
        across = -(-len(shown) // rows)
        pixels = [2 * round(0.5 * dpi * inches) for inches in (4.0 * across, tall * rows)]
        if not _LEAST_PIXELS <= min(pixels) <= max(pixels) < _PIXELS:
            raise ValueError(
                f"dpi = {dpi:g}: frames of {pixels[0]} x {pixels[1]} pixels, give one for {_LEAST_PIXELS} to {_PIXELS}"
            )
        self.figure = figure(pixels[0] / dpi, pixels[1] / dpi, dpi)
        axes = self.figure.subplots(2 * rows, across, squeeze=False, height_ratios=(tall - 1.6, 1.2) * rows)
        traces = [trace(ax, r) for ax, r in zip(axes[1::2].flat, shown, strict=True)]
        top = max(t.top for t in traces)
        for one in traces:
            one.ax.set(xlim=(0.0, end or 1.0), ylim=(-0.05 * top, 1.1 * top))
        self.panels = [
            _Panel(ax, r, below, title, view, exact, arrow)
            for ax, r, below, title in zip(axes[::2].flat, shown, traces, titles, strict=True)
        ]
        self.clock = self.figure.suptitle("t = 0", fontsize=FONT + 1)

    def __len__(self) -> int:
        return len(self.times)

    def images(self) -> Iterator[Image]:
        """Each frame as (height, width, 3) bytes; static parts are drawn once."""
        canvas = cast(FigureCanvasAgg, self.figure.canvas)
        moving = [(panel.ax, artist) for panel in self.panels for artist in panel.moving]
        moving += [(panel.trace.ax, artist) for panel in self.panels for artist in panel.trace.moving]
        canvas.draw()  # lays the axes out
        self.figure.set_layout_engine("none")
        for artist in (self.clock, *(a for _, a in moving)):
            artist.set_animated(True)
        canvas.draw()
        still = canvas.copy_from_bbox(self.figure.bbox)
        for t in self.times:
            canvas.restore_region(still)
            for panel in self.panels:
                panel.show(float(t))
            for ax, artist in moving:
                ax.draw_artist(artist)
            self.clock.set_text(f"t = {t:.{self.digits}f} s")
            self.figure.draw_artist(self.clock)
            yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


class _Panel:
    """The bodies of one recording, with arrows if wanted, and the exact solution as outlines (ghosts): at its
    positions, with the angles of the recording."""

    def __init__(
        self, ax: Axes, recording: Recording, trace: Trace, title: str, view: View, exact: Exact | None,
        arrow: str | None,
    ) -> None:  # fmt: skip
        self.ax, self.recording, self.trace = ax, recording, trace
        frame(ax, view, title)
        readable(ax)
        self.drawing = Drawing(ax, recording.outlines)
        self.moving = self.drawing.artists
        self.trails: list[Line2D] = []
        if recording.position.shape[1] <= _TRAILED:
            self.trails = [
                ax.plot([], [], color=MOVING_COLOR, linewidth=0.8)[0] for _ in range(recording.position.shape[1])
            ]
            self.moving += self.trails
        self.exact = exact
        if self._exact_at(0.0) is None:
            self.exact = None
        else:
            self.ghost = Drawing(ax, recording.outlines, ghost=True)
            self.moving += self.ghost.artists
        self.arrows: Quiver | None = None
        if arrow is not None:
            self.vectors = momenta(recording.velocity, recording.mass) if arrow == "momentum" else recording.velocity
            self.vectors = np.where(np.isfinite(self.vectors), self.vectors, 0.0)
            longest = float(np.hypot(self.vectors[..., 0], self.vectors[..., 1]).max(initial=0.0))
            self.arrows = arrows(ax, recording.position[0], self.vectors[0], longest)
            self.moving.append(self.arrows)

    def show(self, t: float) -> None:
        """Move everything to the recorded moment that is nearest to time t."""
        i = int(np.argmin(np.abs(self.recording.time - t)))
        x, angle = self.recording.position[i], self.recording.angle[i]
        self.drawing.move(x, angle)
        if self.exact is not None:
            # The exact solution at the recorded moment that is shown, not at the time of the frame.
            there = self._exact_at(float(self.recording.time[i]))
            self.ghost.move(np.full_like(x, np.nan) if there is None else there, angle)
        if self.arrows is not None:
            self.arrows.set_offsets(x)
            self.arrows.set_UVC(*self.vectors[i].T)
        for k, trail in enumerate(self.trails):
            trail.set_data(*self.recording.position[: i + 1, k].T)
        self.trace.show(i)

    def _exact_at(self, t: float) -> FloatArray | None:
        """(N, 2) exact positions at the time t, None if they are not known; ValueError for another shape."""
        there = None if self.exact is None else self.exact(t)
        bodies = self.recording.position.shape[1]
        if there is not None and np.shape(there) != (bodies, 2):
            raise ValueError(f"exact({t:g}) has shape {np.shape(there)}: return ({bodies}, 2) positions, or None")
        return there


def _title(recording: Recording) -> str:
    parameters = recording.parameters
    return f"{parameters.get('stepper', 'recording')}, dt = {parameters['dt']:g} s" if "dt" in parameters else ""
