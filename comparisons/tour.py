"""Start here: five small scenes with known solutions, EECA beside pymunk; under a minute. One picture, one film."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons import piles, steps
from comparisons.output import Output, Row
from comparisons.tour_problems import Problem, problems
from eeca_pymunk import render
from eeca_pymunk.compiled import plain
from eeca_pymunk.recorder import step_count

STEPPERS = steps.STEPS
STYLE = {"EECA": ("black", 2.0), "pymunk": ("#d55e00", 1.2), "pymunk tuned": ("#0072b2", 1.2)}
FINER = 2.0  # from one step size to the next
BUDGET = 0.25  # s: a run that takes longer is the last of its stepper
SHORT, REPEATS = 0.05, 5  # s: shorter runs are timed so often
FLOOR = 1e-16  # m: smaller errors are round-off
PILE, PILE_STEPS = 60, 120
FILM, MOMENTS, FRAMES = 0.4, 80, 40  # s, and of the film
STEP = "EECA's step / pymunk's"


@dataclass(frozen=True)
class Point:
    """A stepper at a dt: error of places at the end (m), largest error of the energy, time of all steps (s).

    Time is that of this process, which is the wall's on a machine with nothing else to do.
    """

    stepper: str
    dt: float
    error: float
    energy: float
    wall: float


def measure(problem: Problem, name: str, dt: float) -> Point:
    """Run a problem; the least of some times where a run is short."""
    found = _once(problem, name, dt)
    walls = [found.wall]
    while walls[0] < SHORT and len(walls) < REPEATS:
        walls.append(_once(problem, name, dt).wall)
    return Point(name, dt, found.error, found.energy, min(walls))


def _once(problem: Problem, name: str, dt: float) -> Point:
    scene = problem.build()
    step, count = STEPPERS[name](scene.space), step_count(problem.duration, dt)
    start = ep.measure(scene.space).energy
    look, wall, energy = max(1, count // 100), 0.0, 0.0
    for k in range(0, count, look):
        steps = min(look, count - k)
        clock = time.process_time()
        for _ in range(steps):
            step(dt)
        wall += time.process_time() - clock
        change = ep.measure(scene.space).energy - start
        energy = max(energy, abs(change - problem.energy((k + steps) * dt)) / problem.scale)
    exact = scene.exact(count * dt)
    assert exact is not None  # of all problems it is known
    x = np.array([b.position for b in scene.bodies])
    return Point(name, dt, float(np.linalg.norm(x - exact, axis=1).max()), energy, wall)


def curve(problem: Problem, name: str, bar: tqdm[Any]) -> list[Point]:
    """The problem at its dt and finer ones, until a run takes too long."""
    points = [measure(problem, name, problem.dt)]
    bar.update()
    while points[-1].wall < BUDGET:
        points.append(measure(problem, name, points[-1].dt / FINER))
        bar.set_postfix_str(f"{problem.name}, {name}, dt = {points[-1].dt:.1e}")
    return points


def summary(problem: str, points: list[Point]) -> Row:
    """EECA at its dt, and the smallest error that pymunk comes to in no more time; or in its shortest run, if that is
    longer."""
    ours = next(p for p in points if p.stepper == "EECA")
    others = [p for p in points if p.stepper != "EECA"]
    quickest = min(others, key=lambda p: p.wall)
    best = min((p for p in others if p.wall <= 1.05 * ours.wall), key=lambda p: p.error, default=quickest)
    first = next(p for p in others if p.stepper == "pymunk")
    return {
        "scene": problem,
        "time (ms)": 1e3 * ours.wall,
        "EECA (m)": ours.error,
        "pymunk in that time (m)": best.error,
        "its time (ms)": 1e3 * best.wall,
        "its dt (s)": best.dt,
        "x smaller error": best.error / max(ours.error, FLOOR),
        STEP: ours.wall / first.wall,
    }


def warm() -> None:
    """Load the kernels, or build them; nothing of it is timed."""
    if plain():
        print("no machine code: plain Python, some hundred times slower (python -m eeca_pymunk says why)")
    print(f"kernels are ready ({ep.warmup():.1f} s, not counted below)", flush=True)
    for problem in problems():
        ep.EECA(problem.build().space).step(problem.dt)


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV, one picture, one film."""
    warm()
    output.parameters({"tuned": "no slop, no contact memory, 50 iterations", "full": full})
    found: dict[str, list[Point]] = {}
    with tqdm(total=len(problems()) * len(STEPPERS) + 2, desc="tour", unit="part") as bar:
        for problem in problems():
            found[problem.name] = [p for name in STEPPERS for p in curve(problem, name, bar)]
        price = pile_price()
        bar.update()
        bar.set_postfix_str("film")
        film = filmed(output)
        bar.update()
    rows: list[Row] = [
        {
            "scene": name, "stepper": p.stepper, "dt (s)": p.dt, "error (m)": p.error, "energy error": p.energy,
            "time (ms)": 1e3 * p.wall,
        }
        for name, points in found.items() for p in points
    ]  # fmt: skip
    output.csv(rows, "all")
    at_dt = [row for row in rows if row["dt (s)"] in [p.dt for p in problems() if p.name == row["scene"]]]
    output.table("At equal dt: error of places at the end, largest error of the energy, time of all steps", at_dt, "dt")
    shown = [summary(name, points) for name, points in found.items()]
    output.table("EECA, and pymunk (as shipped or tuned, at any dt) in no more time", shown)
    output.picture(picture(found, shown))
    print(f"-> {film}")
    print("\n".join([*seen(shown, at_dt), *closing(shown, price)]))


def pile_price() -> float:
    """Time of EECA's step over pymunk's in a pile of boxes that falls and settles: the median of steps in turn."""
    spaces = [piles.pile("boxes", PILE, 0.3, 0.5) for _ in range(2)]
    steps = [STEPPERS[name](space) for name, space in zip(("EECA", "pymunk"), spaces, strict=True)]
    walls: list[list[float]] = [[], []]
    for _ in range(PILE_STEPS):
        for step, wall in zip(steps, walls, strict=True):
            clock = time.process_time()
            step(1 / 60)
            wall.append(time.process_time() - clock)
    return median(walls[0][PILE_STEPS // 2 :]) / median(walls[1][PILE_STEPS // 2 :])


def seen(shown: list[Row], at_dt: list[Row]) -> list[str]:
    """What was seen, in three lines."""
    finer = min(float(row["x smaller error"] or 0.0) for row in shown)
    energy = {
        name: max(float(row["energy error"] or 0.0) for row in at_dt if row["stepper"] == name)
        for name in ("EECA", "pymunk")
    }
    price = [float(row[STEP] or 0.0) for row in shown]
    return [
        "",
        f"1. Places: in the time of EECA's run, pymunk's error is {finer:.2g} times larger at least.",
        f"2. Energy: EECA's is off by {energy['EECA']:.0e} at most, pymunk's by {energy['pymunk']:.0e}.",
        f"3. Cost: at equal dt a step of EECA takes {min(price):.2g} to {max(price):.2g} times pymunk's, "
        "in scenes of 1 to 20 bodies, with the default sync=True.",
    ]


def closing(shown: list[Row], price: float) -> list[str]:
    """What to make of it, where pymunk is better, what to try next."""
    worse = [str(r["scene"]) for r in shown if float(r["x smaller error"] or 0.0) < 1.0]
    dearer = [f"{r['scene']} {float(r[STEP] or 0.0):.2g}" for r in shown if float(r[STEP] or 0.0) > 1.1]
    lines = ["", "Where pymunk is better:"]
    if worse:
        lines.append(f"* in no more time its places are as good or better: {', '.join(worse)}.")
    if dearer:
        lines.append(f"* a step at equal dt costs EECA so many times as much: {', '.join(dearer)}.")
    lines += [
        f"* so does a step of a pile of {PILE} boxes: {price:.2g}. If it only has to look right, take pymunk.",
        "",
        "Next: python -m comparisons pool_break --animate gif",
        "and your own space: stepper = ep.EECA(space); stepper.step(dt) in the place of space.step(dt). See README.md.",
    ]
    return lines


def filmed(output: Output) -> str:
    """The gas under EECA and pymunk beside each other, with rings where the disks are."""
    gas = problems()[0]
    exact = gas.build().exact
    steppers = [ep.EECA(gas.build().space), ep.Native(gas.build().space)]
    recordings = [ep.record(stepper, FILM, FILM / MOMENTS) for stepper in steppers]
    path = output.path("gif")
    render.animate(
        recordings,
        path,
        15,
        titles=["EECA", "pymunk"],
        exact=exact,
        view=(-0.02, 1.02, -0.02, 1.02),
        frames=FRAMES,
        dpi=72,
    )
    return str(path)


def picture(found: dict[str, list[Point]], shown: list[Row]) -> Figure:
    """Error against time, a panel for each scene, and the legend in the last one."""
    figure = render.figure(9.0, 6.2)
    axes = figure.subplots(2, len(found) // 2 + 1, sharey=True)
    for ax, row, (name, points) in zip(axes.flat, shown, found.items(), strict=False):
        for stepper, (color, width) in STYLE.items():
            mine = [p for p in points if p.stepper == stepper]
            error = [max(p.error, FLOOR) for p in mine]
            wall = [1e3 * p.wall for p in mine]
            ax.loglog(wall, error, "o-", color=color, linewidth=width, markersize=4, label=stepper)
        told = f"in equal time {_power(float(row['x smaller error'] or 0.0))}"
        ax.set(xlabel="time of all steps (ms)", title=f"{name}\n{told}")
    for ax in axes[:, 0]:
        ax.set_ylabel("error of places (m)")
    for ax in axes.flat[len(found) :]:
        ax.axis("off")
    axes.flat[-1].legend(*axes.flat[0].get_legend_handles_labels(), loc="center", frameon=False)
    return figure


def _power(factor: float) -> str:
    if factor < 1.0:
        return f"{1.0 / factor:.2g} times larger"
    return f"{factor:.2g} times smaller" if factor < 1e3 else f"$10^{{{math.floor(math.log10(factor))}}}$ times smaller"
