"""Hopper filling: energy, leaks and overlap of 665 falling disks, for three time steps (Figs. 12-15)."""

from __future__ import annotations

import copy

import numpy as np
import numpy.typing as npt
import pymunk
from matplotlib.figure import Figure
from tqdm import tqdm

import eeca_pymunk as ep
import scenes
from comparisons import runs
from comparisons.output import Output, Row
from eeca_pymunk import render
from eeca_pymunk.energy.invariants import Invariants
from scenes import Scene
from scenes.hopper import RADIUS, walls

FloatArray = npt.NDArray[np.float64]
STEPS = (2.5e-3, 1e-3, 5e-4)
SHOWN = (0.25, 0.47, 0.65, 0.92)  # s
SMALLEST = 1e-5  # s, the paper's smallest step for the maximum dissipation rule: with --full
LOOKS = 100  # samples of the overlap over a run: it costs more than a step
CLOSE = 1e-4  # s between measures, or one step if longer; disks move less than a tenth of a radius


class Watch:
    """Counts disks whose centre goes through a wall, and keeps the deepest overlap, energies and spaces to draw."""

    def __init__(self, dt: float, duration: float) -> None:
        self.leaked: set[int] = set()
        self.overlap = 0.0
        self.energy: list[tuple[float, float]] = []
        self.moments: list[tuple[float, pymunk.Space]] = []
        self._due = list(SHOWN)
        self._every = max(1, round(duration / dt / LOOKS))
        self._before: FloatArray | None = None

    def __call__(self, k: int, t: float, scene: Scene, report: ep.StepReport | None, now: Invariants) -> None:
        x = np.array([b.position for b in scene.bodies])
        if self._before is not None:
            self.leaked |= set(np.flatnonzero(crossed(self._before, x)).tolist())
        self._before = x
        if k % self._every == 0:
            self.overlap = max(self.overlap, deepest_overlap(x))
            self.energy.append((t, now.energy))
        if self._due and t >= self._due[0] - 1e-9:
            self._due.pop(0)
            self.moments.append((t, copy.deepcopy(scene.space)))


def crossed(before: FloatArray, after: FloatArray) -> npt.NDArray[np.bool_]:
    """(N,) whether the centre went through a wall of the hopper between two configurations."""
    through = np.zeros(len(before), bool)
    for a, b in np.array(walls()):
        edge = b - a
        side = [(x - a) @ np.array([-edge[1], edge[0]]) for x in (before, after)]
        change = side[0] - side[1]
        at = before + np.divide(side[0], change, out=np.zeros_like(change), where=change != 0)[:, None] * (
            after - before
        )
        along = (at - a) @ edge / (edge @ edge)
        through |= (side[0] * side[1] < 0) & (along > 0) & (along < 1)
    return through


def deepest_overlap(x: FloatArray) -> float:
    """Deepest overlap of two disks, in radii; 0 if none."""
    d2 = np.sum(x * x, axis=1)[:, None] + np.sum(x * x, axis=1) - 2.0 * (x @ x.T)
    np.fill_diagonal(d2, np.inf)
    return max(0.0, float(2.0 - np.sqrt(max(d2.min(), 0.0)) / RADIUS))


def numerical_damping(frequency: FloatArray, beta: float, gamma: float) -> FloatArray:
    """xi_N of Newmark's rule on a linear oscillator against omega dt (Fig. 15), from the spectrum of one step."""
    ratios = []
    for w in frequency:
        # Unknowns q, dt v; a_n = -w² q_n / dt², a_np1 likewise.
        left = np.array([[1.0 + beta * w * w, 0.0], [gamma * w * w, 1.0]])
        right = np.array([[1.0 - (0.5 - beta) * w * w, 1.0], [-(1.0 - gamma) * w * w, 1.0]])
        roots = np.linalg.eigvals(np.linalg.solve(left, right))
        root = roots[np.argmax(np.abs(roots))]  # the slower one where they are real
        decay, turn = -np.log(abs(root)), abs(np.angle(root))
        ratios.append(decay / np.hypot(decay, turn) if turn or decay else 0.0)
    return np.array(ratios)


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV and PNG."""
    scene = scenes.build("hopper")
    output.parameters({"K": scene.stiffness, "duration": scene.duration, **scene.parameters, "dt": STEPS})
    rows: list[Row] = []
    watches: dict[tuple[str, float], Watch] = {}
    makes = runs.steppers(scene.stiffness, thousand=True) | {"EECA Midstep, sync": runs.eeca(ep.Midstep(), sync=True)}
    jobs = [(name, make, dt) for dt in STEPS for name, make in makes.items()]
    if full:
        jobs.append(("max dissipation", makes["max dissipation"], SMALLEST))
    for name, make, dt in tqdm(jobs, desc="hopper", unit="run", disable=None):
        watch = watches[name, dt] = Watch(dt, scene.duration)
        every = max(1, round(CLOSE / dt))
        result = runs.run(scenes.build("hopper", dt=dt), make, observe=watch, every=every, label=f"{name}, dt={dt}")
        rows.append({
            "stepper": name, "dt (s)": dt, **result.columns(closed=False),
            "leaked": len(watch.leaked), "overlap (r)": watch.overlap,
        })  # fmt: skip
    base = {row["dt (s)"]: row["ms/step"] for row in rows if row["stepper"] == "native default"}
    for row in rows:
        reference = base.get(row["dt (s)"])
        row["x native"] = row["ms/step"] / reference if reference else None  # type: ignore[index, operator]
    output.table("Hopper, 1 s; leaked of 665, deepest overlap in radii", rows)
    for name in ("EECA Midstep", "EECA Dashpot xi=200", "native default", "trapezoidal", "max dissipation"):
        output.picture(_strip(name, watches), "strip_" + name.replace(" ", "_").replace("=", "_"))
    output.picture(_energies(watches), "figs_13_14")
    output.picture(_fig_15(), "fig_15")


def _strip(name: str, watches: dict[tuple[str, float], Watch]) -> Figure:
    steps = [dt for n, dt in watches if n == name]
    figure = render.figure(12.0, 3.2 * len(steps))
    for line, dt in zip(np.atleast_2d(figure.subplots(len(steps), len(SHOWN))), steps, strict=True):
        for i, ax in enumerate(line):
            moments = watches[name, dt].moments
            if i < len(moments):
                t, space = moments[i]
                render.snapshot(space, ax, title=f"dt = {dt:g} s, {t:.2f} s", view=(-0.7, 0.7, -0.25, 1.1))
            else:
                ax.set_axis_off()
                ax.set_title(f"dt = {dt:g} s, {SHOWN[i]} s: blown up")
    figure.suptitle(f"Hopper, {name} (paper Figs. 12-14)")
    return figure


def _energies(watches: dict[tuple[str, float], Watch]) -> Figure:
    names = list(dict.fromkeys(name for name, _ in watches))
    figure = render.figure(12.0, 6.5)
    columns = -(-len(names) // 2)
    axes = list(figure.subplots(2, columns).flat)
    for ax in axes[len(names) :]:
        ax.set_axis_off()
    for ax, name in zip(axes, names, strict=False):
        for dt in (dt for n, dt in watches if n == name):
            t, energy = np.array(watches[name, dt].energy).T
            ax.plot(t, energy / energy[0], label=f"dt = {dt:g} s")
        ax.set_title(name)
        ax.set_ylim(0.0, 3.0)
        ax.set(xlabel="time (s)", ylabel="E / E at start")
    # Every dt that some rule takes.
    told = {label: line for ax in axes for line, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    spare = axes[len(names)] if len(names) < len(axes) else axes[0]
    spare.legend(told.values(), told.keys(), loc="center", fontsize=9)
    figure.suptitle("Hopper: energy of the bodies (paper Figs. 13, 14)")
    return figure


def _fig_15() -> Figure:
    figure = render.figure(5.0, 3.5)
    ax = figure.add_subplot()
    frequency = np.linspace(0.0, 10.0, 201)
    for name, beta, gamma in (("max dissipation", 0.49, 1.0), ("trapezoidal", 0.25, 0.5)):
        ax.plot(frequency, numerical_damping(frequency, beta, gamma), label=name)
    ax.set(xlabel="omega dt", ylabel="numerical damping", ylim=(-0.02, 1.0), title="Newmark's rules (paper Fig. 15)")
    ax.legend()
    return figure
