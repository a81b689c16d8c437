"""1000 gases that start with equal speeds: where the speeds end, against Maxwell's distribution. Takes --workers."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

import eeca_pymunk as ep
import scenes
from comparisons import pool, runs
from comparisons.output import Output, Row
from eeca_pymunk import render

FloatArray = npt.NDArray[np.float64]
SEEDS, COUNT, RADIUS, SPEED = 1000, 20, 0.03, 1.0
DT, DURATION = 0.01, 4.0  # s; about twenty impacts of each disk
STEPPERS = {"EECA": runs.eeca(ep.TimeOfImpact()), "pymunk": runs.native(), "pymunk tuned": runs.native(50)}
BINS = np.linspace(0.0, 3.0, 31)


def speeds(case: tuple[str, int]) -> tuple[list[float], float]:
    """One gas under one stepper, by seed and name: speeds of the disks at the end (m/s), largest drift of its energy.

    All disks start with the same speed in directions of their own. Between walls momentum is not kept; energy is.
    """
    name, seed = case
    scene = scenes.build("gas", count=COUNT, radius=RADIUS, seed=seed, dt=DT, duration=DURATION)
    for body in scene.bodies:
        body.velocity = body.velocity.normalized() * SPEED
    result = runs.run(scene, STEPPERS[name])
    return runs.speeds(scene).tolist(), result.energy_drift


def maxwell(v: FloatArray) -> FloatArray:
    """Part of the disks slower than v in a large gas in two dimensions: 1 - exp(-v² / <v²>)."""
    part: FloatArray = -np.expm1(-((v / SPEED) ** 2))
    return part


def finite(v: FloatArray, count: int = COUNT) -> FloatArray:
    """The same where `count` disks share their energy: 1 - (1 - v² / count <v²>)^(count - 1).

    All velocities of one total energy are equally likely, points on a sphere in 2 count dimensions; the square of
    the part of such a point in two of them has a beta distribution.
    """
    part: FloatArray = 1.0 - np.maximum(1.0 - (v / SPEED) ** 2 / count, 0.0) ** (count - 1)
    return part


def distance(found: FloatArray, part: FloatArray) -> float:
    """Kolmogorov's: the largest difference between what was found, sorted, and the distribution at these values."""
    n = len(found)
    return float(max((np.arange(1, n + 1) / n - part).max(), (part - np.arange(n) / n).max()))


def rows(seeds: int, workers: int) -> tuple[list[Row], dict[str, FloatArray]]:
    """The table, and the speeds (seeds x COUNT,), sorted, under each stepper."""
    table: list[Row] = []
    held: dict[str, FloatArray] = {}
    ended = pool.over(speeds, [(name, seed) for name in STEPPERS for seed in range(seeds)], workers)
    for k, name in enumerate(STEPPERS):
        found = ended[k * seeds : (k + 1) * seeds]
        v = held[name] = np.sort(np.concatenate([one for one, _ in found]))
        drifts = np.array([drift for _, drift in found])
        table.append({
            "stepper": name, "gases": seeds, "mean square (m2/s2)": float((v**2).mean()),
            "distance to finite": distance(v, finite(v)), "distance to Maxwell": distance(v, maxwell(v)),
            "5 % by chance": 1.36 / math.sqrt(len(v)), "max |dE/E|": float(drifts.max()),
            "median |dE/E|": float(np.median(drifts)),
        })  # fmt: skip
    return table, held


def run(output: Output, full: bool, workers: int = 1) -> None:
    """Print the table; write CSV and PNG."""
    output.parameters({"disks": COUNT, "radius": RADIUS, "dt": DT, "duration": DURATION, "workers": workers})
    table, held = rows(SEEDS, workers)
    output.table(f"{SEEDS} gases of {COUNT} disks: distance of the speeds from two distributions (Kolmogorov)", table)
    print(f"finite: exact for {COUNT} disks that share their energy; Maxwell: for infinitely many.")
    output.picture(picture(held))


def picture(held: dict[str, FloatArray]) -> Figure:
    """Histograms of the speeds, and both densities."""
    figure = render.figure(10.0, 3.6)
    axes = figure.subplots(1, len(held), sharey=True)
    v = np.linspace(0.0, float(BINS[-1]), 200)
    for ax, (name, found) in zip(np.atleast_1d(axes), held.items(), strict=True):
        ax.hist(found, BINS, density=True, color="#56b4e9", label=f"{len(found)} speeds")
        ax.plot(v, np.gradient(maxwell(v), v), "--", color="#d55e00", label="Maxwell")
        ax.plot(v, np.gradient(finite(v), v), color="black", label=f"exact for {COUNT} disks")
        ax.axvline(SPEED, color="#999999", linewidth=1.0, label="start")
        ax.set(title=name, xlabel="speed (m/s)")
    np.atleast_1d(axes)[0].set_ylabel("density (s/m)")
    np.atleast_1d(axes)[0].legend(fontsize=8)
    return figure
