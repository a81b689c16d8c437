"""Breaking of pool balls: momenta, energy and symmetry of three racks (Figs. 8, 9, Table II)."""

from __future__ import annotations

import copy

import numpy as np
import pymunk
from matplotlib.figure import Figure

import eeca_pymunk as ep
import scenes
from comparisons import runs
from comparisons.output import Output, Row
from eeca_pymunk import render
from eeca_pymunk.energy.invariants import Invariants
from scenes import Scene
from scenes.pool_break import mirror

# Times (s) of the pictures; the paper's clock starts when the cue touches, 1 ms after ours.
SHOWN = {"i": (0.0, 0.0021, 0.0023, 0.051), "ii": (0.0, 0.0023, 0.0073, 0.061), "iii": (0.0, 0.0025, 0.0069, 0.99)}
SYMMETRIC_UNTIL = 0.005  # s


def asymmetry(scene: Scene) -> float:
    """Largest distance (m) of a disk from the mirror image of its partner."""
    x = np.array([b.position for b in scene.bodies])
    return float(np.linalg.norm(x - x[mirror()] * (-1.0, 1.0), axis=1).max())


class Watch:
    """Keeps the asymmetry until 5 ms, and copies of the space at the moments of the pictures."""

    def __init__(self, case: str) -> None:
        self.asymmetry = 0.0
        self.end: Invariants | None = None
        self.moments: list[tuple[float, pymunk.Space]] = []
        self._due = list(SHOWN[case])

    def __call__(self, k: int, t: float, scene: Scene, report: ep.StepReport | None, now: Invariants) -> None:
        if t <= SYMMETRIC_UNTIL:
            self.asymmetry = max(self.asymmetry, asymmetry(scene))
        self.end = now
        if self._due and t >= self._due[0] - 1e-9:
            self._due.pop(0)
            self.moments.append((t, copy.deepcopy(scene.space)))


def run(output: Output, full: bool) -> None:
    """Print the table; write CSV and PNG."""
    scene = scenes.build("pool_break")
    output.parameters({"K": scene.stiffness, "dt": scene.dt, "duration": scene.duration, "mass": 0.15, "v": "(0, 10)"})
    rows: list[Row] = []
    watches: dict[tuple[str, str], Watch] = {}
    for case in SHOWN:
        makes = runs.steppers(scene.stiffness, thousand=True)
        for name, make in makes.items():
            watch = watches[case, name] = Watch(case)
            result = runs.run(scenes.build("pool_break", case=case), make, observe=watch, label=f"{case} {name}")
            assert watch.end is not None  # observed at the start at least
            rows.append({
                "stepper": name, "case": case, "Lx": float(watch.end.linear_momentum[0]),
                "Ly": float(watch.end.linear_momentum[1]), "E (J)": watch.end.energy,
                "asymmetry 5 ms (m)": watch.asymmetry if case != "iii" else None, **result.columns(closed=True),
            })  # fmt: skip
    output.table("Table II: momenta (kg m/s) and energy after 1 s; at the start 0, 1.5 and 7.5", rows)
    for name, file in (("EECA Dashpot xi=200", "figs_8_9"), ("native default", "figs_8_9_native")):
        output.picture(_draw({case: watches[case, name] for case in SHOWN}, name), file)


def _draw(watch: dict[str, Watch], name: str) -> Figure:
    figure = render.figure(12.0, 9.5)
    for line, case in zip(figure.subplots(3, 4), SHOWN, strict=True):
        for ax, (t, space) in zip(line, watch[case].moments, strict=True):
            render.snapshot(space, ax, momentum=True, title=f"case {case}, {1e3 * t:.2f} ms", view=_view(space))
            ax.tick_params(labelsize=6)
    figure.suptitle(f"Pool break, {name}: linear momenta (paper Figs. 8, 9)")
    return figure


def _view(space: pymunk.Space) -> tuple[float, float, float, float]:
    """A square around the rack and where the cue starts, with room for arrows. The cue leaves it far behind."""
    x = np.array([(0.0, -0.1), *(b.position for b in list(space.bodies)[1:])])
    low, high = x.min(axis=0), x.max(axis=0)
    middle, half = 0.5 * (low + high), 0.72 * float((high - low).max())
    return middle[0] - half, middle[0] + half, middle[1] - half, middle[1] + half
