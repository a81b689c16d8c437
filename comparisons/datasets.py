"""Data sets: two published generators of films of two balls by their settings, and how many of their films are wrong.

Each generator is told by its settings alone; none of its code is here. Its films are compared with the closed form of
two elastic balls that meet head on:

    v_1' = v_1 - 2 m_2 (v_1 - v_2) / (m_1 + m_2),   t = (x_2 - x_1 - r_1 - r_2) / (v_1 - v_2),   and 1, 2 exchanged.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pymunk
from matplotlib.figure import Figure
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons import engines
from comparisons.output import Output, Row
from eeca_pymunk import render

FloatArray = npt.NDArray[np.float64]
FILMS = 300


@dataclass(frozen=True)
class Films:
    """F films of two balls on a line: x, v, radius and mass (F, 2) at the start.

    Attributes:
        frames: how many each has.  interval: s between them.  pixels: per metre.
    """

    x: FloatArray
    v: FloatArray
    radius: FloatArray
    mass: FloatArray
    frames: int
    interval: float
    pixels: float

    @property
    def times(self) -> FloatArray:
        """(frames,) s."""
        times: FloatArray = self.interval * np.arange(1, self.frames + 1, dtype=float)
        return times

    def impact(self) -> FloatArray:
        """(F,) instants, s."""
        impact: FloatArray = (self.x[:, 1] - self.x[:, 0] - self.radius.sum(axis=1)) / (self.v[:, 0] - self.v[:, 1])
        return impact

    def after(self) -> FloatArray:
        """(F, 2) velocities after the impact, m/s."""
        share = 2.0 * self.mass[:, ::-1] / self.mass.sum(axis=1)[:, None]
        after: FloatArray = self.v - share * (self.v - self.v[:, ::-1])
        return after

    def exact(self) -> FloatArray:
        """(F, frames, 2) places, m."""
        t, hit = self.times[None, :, None], self.impact()[:, None, None]
        places: FloatArray = (
            self.x[:, None] + self.v[:, None] * np.minimum(t, hit) + self.after()[:, None] * np.maximum(t - hit, 0.0)
        )
        return places

    def space(self, i: int) -> pymunk.Space:
        """Film number i as a pymunk space."""
        space = pymunk.Space()
        for x, v, radius, mass in zip(self.x[i], self.v[i], self.radius[i], self.mass[i], strict=True):
            body = pymunk.Body(float(mass), pymunk.moment_for_circle(float(mass), 0.0, float(radius)))
            body.position, body.velocity = (float(x), 0.0), (float(v), 0.0)
            ball = pymunk.Circle(body, float(radius))
            ball.elasticity = 1.0
            space.add(body, ball)
        return space


def box2d_settings(slow: bool, films: int = FILMS, seed: int = 0) -> Films:
    """Balls of density 1 and radius .5 to 1.5 m in a world of 10 m, 256 pixels wide; speeds 1 to 4 m/s, of the slow
    test set 0 to .8 m/s; 32 frames at intervals of .1 s, the impact at least 8 of them from either end."""
    rng = np.random.default_rng(seed)
    found: list[tuple[float, ...]] = []
    while len(found) < films:
        r1, r2 = rng.uniform(0.5, 1.5, 2)
        v1, v2 = rng.uniform(0.0, 0.8, 2) if slow else rng.uniform(1.0, 4.0, 2)
        apart = rng.uniform(0.8, 2.4) * (v1 + v2) + r1 + r2
        if apart < 10.0 - r1 - r2:
            x1 = rng.uniform(r1, 10.0 - r2 - apart)
            found.append((x1, x1 + apart, v1, -v2, r1, r2))
    table = np.array(found)
    radius = table[:, 4:6]
    return Films(table[:, 0:2], table[:, 2:4], radius, math.pi * radius**2, 32, 0.1, 25.6)


def pymunk_settings(films: int = FILMS, seed: int = 1) -> Films:
    """Balls of 1 to 5 kg and radius .42 to .78 m, from 2 and 12 m at 2 to 8 m/s towards one another, in a picture of
    800 pixels for 14 m; 30 frames at intervals of .1 s."""
    rng = np.random.default_rng(seed)
    mass, speed = rng.uniform(1.0, 5.0, (films, 2)), rng.uniform(2.0, 8.0, (films, 2))
    radius = np.floor(21.0 + 18.0 * (mass - 1.0) / 4.0) / 50.0
    return Films(np.tile((2.0, 12.0), (films, 1)), speed * (1.0, -1.0), radius, mass, 30, 0.1, 800.0 / 14.0)


Made = tuple[FloatArray, FloatArray, float]  # places (F, frames, 2), velocities at the end (F, 2), seconds
Ways = dict[str, Callable[[Films], "Made | str"]]


def by_eeca(films: Films) -> Made:
    """One step a frame, spaces and steppers included."""
    places, ends = np.zeros((len(films.x), films.frames, 2)), np.zeros((len(films.x), 2))
    begun = time.perf_counter()
    for i in range(len(films.x)):
        recording = ep.record(ep.EECA(films.space(i)), films.frames * films.interval, films.interval)
        places[i], ends[i] = recording.position[1:, :, 0], recording.velocity[-1, :, 0]
    return places, ends, time.perf_counter() - begun


def by_pymunk(films: Films, substeps: int = 1) -> Made:
    """So many steps a frame."""
    places, ends = np.zeros((len(films.x), films.frames, 2)), np.zeros((len(films.x), 2))
    begun = time.perf_counter()
    for i in range(len(films.x)):
        space = films.space(i)
        bodies = list(space.bodies)
        for frame in range(films.frames):
            for _ in range(substeps):
                space.step(films.interval / substeps)
            places[i, frame] = [b.position.x for b in bodies]
        ends[i] = [b.velocity.x for b in bodies]
    return places, ends, time.perf_counter() - begun


def by_box2d(films: Films, substeps: int = 10) -> Made | str:
    """Ten steps of .01 s a frame, 15 and 20 iterations; or why there are none."""
    job = {
        "gravity": 0.0, "friction": 0.0, "elasticity": 1.0, "rod": False, "walls": [], "iterations": [15, 20],
        "dt": films.interval / substeps, "steps": films.frames * substeps, "every": substeps,
    }  # fmt: skip
    each = [
        {
            "start": [[x, 5.0, 0.0, v, 0.0, 0.0] for x, v in zip(films.x[i], films.v[i], strict=True)],
            "radius": films.radius[i].tolist(), "mass": films.mass[i].tolist(),
            "moment": (0.5 * films.mass[i] * films.radius[i] ** 2).tolist(),
        }
        for i in range(len(films.x))
    ]  # fmt: skip
    made = engines.films(job, each)
    if isinstance(made, str):
        return made
    states = np.array([one.states for one in made])
    return states[:, :, :, 0], states[:, -1, :, 3], sum(one.seconds for one in made)


def judged(films: Films, made: Made) -> Row:
    """Shares of films that are wrong."""
    places, ends, seconds = made
    off = np.abs(places - films.exact()).max(axis=2) * films.pixels
    closing = np.abs(films.v[:, 0] - films.v[:, 1])
    overlap = (films.radius.sum(axis=1)[:, None] - (places[..., 1] - places[..., 0])) * films.pixels
    return {
        "wrong velocities at the end": float((np.abs(ends - films.after()).max(axis=1) > 0.01 * closing).mean()),
        "passed through": float((places[:, -1, 0] > places[:, -1, 1]).mean()),
        "overlap > 1 px": float((overlap.max(axis=1) > 1.0).mean()),
        "a frame off > 1 px": float((off.max(axis=1) > 1.0).mean()),
        "frames off > 1 px": float((off > 1.0).mean()),
        "farthest (px)": float(off.max()),
        "films/s": len(films.x) / seconds,
    }


def generators() -> list[tuple[str, Films, Ways]]:
    """Names, films, and what makes them."""
    box2d: Ways = {"EECA, 1 step a frame": by_eeca, "Box2D, 10 steps": by_box2d}
    munk: Ways = {
        "EECA, 1 step a frame": by_eeca,
        "pymunk, 1 step": by_pymunk,
        "pymunk, 100 steps": lambda films: by_pymunk(films, 100),
    }
    return [
        ("Box2D's, training", box2d_settings(False), box2d),
        ("Box2D's, slow tests", box2d_settings(True), box2d),
        ("pymunk's", pymunk_settings(), munk),
    ]


def picture(found: dict[tuple[str, str], FloatArray], sets: dict[str, Films]) -> Figure:
    """Of two sets the film that is farthest off: places over time."""
    chosen = [("Box2D's, slow tests", "Box2D, 10 steps"), ("pymunk's", "pymunk, 1 step")]
    figure = render.figure(9.5, 4.4)
    for ax, (name, engine) in zip(figure.subplots(1, 2), chosen, strict=True):
        films = sets[name]
        shown = found.get((name, engine))
        i = 0 if shown is None else int(np.abs(shown - films.exact()).max(axis=(1, 2)).argmax())
        for ball, colour in enumerate(("tab:blue", "tab:orange")):
            ax.fill_between(
                films.times, films.exact()[i, :, ball] - films.radius[i, ball],
                films.exact()[i, :, ball] + films.radius[i, ball], color=colour, alpha=0.2, linewidth=0.0,
                label=f"ball {ball + 1}, exact",
            )  # fmt: skip
            ax.plot(films.times, found[name, "EECA, 1 step a frame"][i, :, ball], "k.", markersize=4,
                    label="EECA" if ball else None)  # fmt: skip
            if shown is not None:
                ax.plot(films.times, shown[i, :, ball], color=colour, label=f"ball {ball + 1}, {engine}")
        ax.set(xlabel="t (s)", ylabel="x (m)", title=f"settings: {name}; the film farthest off")
        ax.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncol=3, frameon=False)
    return figure


def run(output: Output, full: bool) -> None:
    """Print the table; write CSV and PNG."""
    ep.warmup()
    output.parameters({"films of each set": FILMS})
    by_eeca(pymunk_settings(3))
    rows: list[Row] = []
    found: dict[tuple[str, str], FloatArray] = {}
    sets = {}
    for name, films, ways in tqdm(generators(), desc="data sets", unit="set", disable=None):
        sets[name] = films
        for engine, make in ways.items():
            made = make(films)
            if isinstance(made, str):
                print(f"# no films of {engine}: {made}")
                continue
            rows.append({"settings": name, "engine": engine, **judged(films, made)})
            found[name, engine] = made[0]
    output.table("Two balls that meet head on, against the closed form: shares", rows)
    output.picture(picture(found, sets))
