"""Carom: trajectory, velocities and energy of one disk in a box against the exact solution (Figs. 6, 7)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes

import eeca_pymunk as ep
import scenes
from comparisons import runs
from comparisons.output import Output
from eeca_pymunk import render
from eeca_pymunk.energy.invariants import Invariants
from scenes import Scene

STEPS = (0.0025, 0.0017)
SHOWN = 1.25  # s of the trajectory in the pictures


@dataclass
class Track:
    """Moments of a run, and the largest change of the angle |v_y / v_x| to the walls, in degrees."""

    time: list[float] = field(default_factory=list)
    position: list[tuple[float, float]] = field(default_factory=list)
    velocity: list[tuple[float, float]] = field(default_factory=list)
    energy: list[float] = field(default_factory=list)
    turned: float = 0.0

    def __call__(self, k: int, t: float, scene: Scene, report: ep.StepReport | None, now: Invariants) -> None:
        body = scene.bodies[0]
        angle = float(np.degrees(np.arctan2(abs(body.velocity.y), abs(body.velocity.x))))
        if k == 0:
            self.first = angle
        self.turned = max(self.turned, abs(angle - self.first))
        if t <= SHOWN:
            self.time.append(t)
            self.position.append(body.position)
            self.velocity.append(body.velocity)
            self.energy.append(now.energy)


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV and PNG."""
    scene = scenes.build("carom")
    output.parameters({"K": scene.stiffness, "duration": scene.duration, **scene.parameters, "dt": STEPS})
    rows, tracks = [], {}
    for dt in STEPS:
        for name, make in runs.steppers(scene.stiffness, (1.0, 200.0)).items():
            track = Track()
            result = runs.run(scenes.build("carom", dt=dt), make, observe=track, label=f"{name}, dt={dt}")
            rows.append({
                "stepper": name, "dt (s)": dt, **result.columns(closed=False), "max turn (deg)": track.turned
            })  # fmt: skip
            tracks[name, dt] = track
    output.table("Carom after 10 s; the angle to the walls should not turn", rows)
    figure = render.figure(9.0, 13.0)
    shown = ["EECA Dashpot xi=1", "EECA Dashpot xi=200", "native default", "trapezoidal", "max dissipation"]
    axes = figure.subplots(len(shown), 2, width_ratios=(1, 2))
    for (left, right), name in zip(axes, shown, strict=True):
        _draw(left, right, name, tracks[name, STEPS[0]])
    figure.suptitle(f"Carom, dt = {STEPS[0]} s: path for {SHOWN} s, velocity and energy (paper Figs. 6, 7)")
    output.picture(figure)


def _draw(left: Axes, right: Axes, name: str, track: Track) -> None:
    x, y = np.array(track.position).T
    left.plot(x, y, linewidth=1)
    left.plot(x[:1], y[:1], "ko", markersize=4)
    left.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", title=name, xlabel="x (m)", ylabel="y (m)")
    vx, vy = np.array(track.velocity).T
    right.plot(track.time, vx, label="v_x", color="#0072b2")
    right.plot(track.time, vy, label="v_y", color="#d55e00", linestyle="--")
    right.set(xlabel="time (s)", ylabel="velocity (m/s)")
    energy = right.twinx()
    energy.plot(track.time, track.energy, color="black")
    energy.set_ylabel("energy (J)")
    energy.set_ylim(0, 1.25 * max(track.energy))
    right.plot([], [], label="E", color="black")
    right.legend(loc="lower right", bbox_to_anchor=(1.0, 0.99), ncol=3, fontsize=8, frameon=False, borderpad=0.0)
