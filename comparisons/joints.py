"""Joints: error against time of pendulums, a cradle, a chain and a linkage; what a step costs beside pymunk's.

EECA and pymunk at 10 and 100 iterations; time is that of this process over whole steps, in turn. Errors are distances
from published digits, closed forms, or the same bars by their angles alone.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pymunk
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons import runs, scaling
from comparisons.hard_cases.joints import apart
from comparisons.output import Output, Row
from eeca_pymunk import render
from eeca_pymunk.recorder import step_count
from scenes import linkages, pendulum, rods
from scenes.bars import Bars
from scenes.scene import FloatArray

EECA = "EECA"
ITERATIONS = (10, 100)
BUDGET = 0.35  # s: a run that takes longer is the last of its stepper
FINEST = {EECA: 1 / 960, "native 10": 1 / 30_720, "native 100": 1 / 30_720}
FLOOR = 1e-15  # m, for pictures
_LABEL = {f"native {n}": f"pymunk, {n} iterations" for n in (10, 100)}
STYLE = {EECA: ("black", "o"), "native 10": ("#d55e00", "s"), "native 100": ("#0072b2", "^")}
LINKS = 20


@dataclass(frozen=True)
class Problem:
    """A space and where a body of it is in the end: `place(space)` should be `end`, m; the first dt in s.

    `floor` is how well the end is known, `scale` an energy to count errors of the energy in, J.
    """

    name: str
    build: Callable[[], pymunk.Space]
    dt: float
    duration: float
    place: Callable[[pymunk.Space], FloatArray]
    end: FloatArray
    scale: float
    floor: float = FLOOR


def problems() -> list[Problem]:
    """Pendulum, double pendulum, cradle, chain, four-bar."""
    cradle = rods.cradle()
    end = cradle.exact(2.0)
    assert end is not None
    bars = Bars(
        np.ones(LINKS), np.full(LINKS, 1 / 12), np.full(LINKS, 0.5), np.ones(LINKS), np.full(LINKS, -0.5),
        linkages.GRAVITY,
    )  # fmt: skip
    bars.run(1.0, 2000)
    return [
        Problem("pendulum", linkages.pendulum, 1 / 30, 10.0, first, np.array(linkages.PENDULUM_AT[10.0]), 9.81),
        Problem("double pendulum", linkages.rods, 1 / 30, 1.0, last, np.array(linkages.RODS_AT[1.0]), 20.0),
        Problem("cradle", lambda: rods.cradle().space, 1 / 60, 2.0, everywhere, end, 2.3, 1e-5),
        Problem("chain of 20", hanging_chain, 1 / 60, 1.0, everywhere, bars.places(), 9.81 * 200, 1e-9),
        Problem(
            "four-bar", lambda: linkages.four_bars(2), 1 / 60, 10.0, crank, np.array(linkages.FOUR_BAR_AT_10[2]), 34.0
        ),
    ]  # fmt: skip


def hanging_chain() -> pymunk.Space:
    """Twenty bars of 1 m, let go half a radian below the horizontal."""
    return linkages.chain(LINKS, lean=0.5)


def first(space: pymunk.Space) -> FloatArray:
    """(2,) place of the first body."""
    return np.array(next(iter(space.bodies)).position)


def last(space: pymunk.Space) -> FloatArray:
    """(2,) place of the last body."""
    return np.array(list(space.bodies)[-1].position)


def everywhere(space: pymunk.Space) -> FloatArray:
    """(N, 2) places of all bodies."""
    return np.array([b.position for b in space.bodies])


def crank(space: pymunk.Space) -> FloatArray:
    """(2,) end of the first crank."""
    return np.array(next(iter(space.bodies)).local_to_world((0.5, 0.0)))


def steppers(build: Callable[[], pymunk.Space]) -> dict[str, tuple[pymunk.Space, scaling.Runner]]:
    """pymunk with each number of iterations, and EECA, on spaces of their own."""
    found = {}
    for iterations in ITERATIONS:
        space = build()
        space.iterations = iterations
        found[f"native {iterations}"] = (space, scaling.Runner(space.step))
    space = build()
    found[EECA] = (space, scaling.Runner(ep.EECA(space).step))
    return found


def measure(problem: Problem, name: str, dt: float) -> Row:
    """One run; energy and joints are looked at a hundred times on the way, off the clock."""
    space, runner = steppers(problem.build)[name]
    count = step_count(problem.duration, dt)
    look, seconds, drift, gap = max(1, count // 100), 0.0, 0.0, 0.0
    start = ep.measure(space).energy
    for k in range(0, count, look):
        seconds += runner.run(dt, min(look, count - k))
        drift = max(drift, abs(ep.measure(space).energy - start) / problem.scale)
        gap = max(gap, apart(space))
    off = problem.place(space) - problem.end
    error = float(np.sqrt((off**2).sum(axis=-1)).max())
    return {
        "scene": problem.name, "stepper": name, "dt (s)": dt, "error (m)": error, "energy error": drift,
        "joints apart (m)": gap, "time (ms)": 1e3 * seconds,
    }  # fmt: skip


def curves(problem: Problem, budget: float) -> list[Row]:
    """All steppers at halved steps, in turn, each until a run takes longer than the budget (s)."""
    rows: list[Row] = []
    going, dt = [*(f"native {n}" for n in ITERATIONS), EECA], problem.dt
    while going:
        for name in tuple(going):
            rows.append(measure(problem, name, dt))
            if number(rows[-1], "time (ms)") > 1e3 * budget or dt < 1.01 * FINEST[name]:
                going.remove(name)
        dt *= 0.5
    return rows


def number(row: Row, column: str) -> float:
    """A number of a table; NaN where there is none."""
    value = row[column]
    return float(value) if isinstance(value, int | float) else float("nan")


def summary(problem: Problem, rows: list[Row]) -> Row:
    """EECA at its second dt, and the best that pymunk comes to in no more time."""
    mine = [r for r in rows if r["scene"] == problem.name]
    ours = [r for r in mine if r["stepper"] == EECA]
    chosen = ours[min(1, len(ours) - 1)]
    others = [r for r in mine if r["stepper"] != EECA]
    quick = [r for r in others if number(r, "time (ms)") <= number(chosen, "time (ms)")]
    best = min(quick or [min(others, key=lambda r: number(r, "time (ms)"))], key=lambda r: number(r, "error (m)"))
    return {
        "scene": problem.name, "EECA's dt (s)": chosen["dt (s)"], "EECA (m)": chosen["error (m)"],
        "its energy error": chosen["energy error"], "time (ms)": chosen["time (ms)"],
        "slope in dt": slope(ours, problem.floor), "pymunk in no more time (m)": best["error (m)"],
        "at dt (s)": best["dt (s)"], "by": best["stepper"], "energy error": best["energy error"],
    }  # fmt: skip


def slope(rows: list[Row], floor: float) -> float:
    """Of the error in dt, over the finer half of the runs whose errors are not round-off."""
    seen = [(number(r, "dt (s)"), number(r, "error (m)")) for r in rows if number(r, "error (m)") > 10.0 * floor]
    seen = seen[len(seen) // 2 :] if len(seen) > 3 else seen[-2:]
    return runs.slope(*(np.array(x) for x in zip(*seen, strict=True))) if len(seen) > 1 else float("nan")


@dataclass(frozen=True)
class Price:
    """A scene whose step is timed: at which dt (s), after how many steps, and what its step may cost."""

    name: str
    build: Callable[[], pymunk.Space]
    dt: float
    warm: int
    limit: float


def prices() -> list[Price]:
    """Scenes whose steps are timed, small and large."""
    return [
        Price("pendulum", lambda: pendulum.build().space, 1 / 240, 50, 15.0),
        Price("double pendulum", linkages.bars, 1 / 240, 50, 15.0),
        Price("chain of 20", lambda: linkages.chain(20, lean=0.5), 1 / 240, 20, 12.0),
        Price("chain of 100", lambda: linkages.chain(100, lean=0.5), 1 / 240, 20, 15.0),
        Price("20 planks on pivots, on the floor", lambda: linkages.planks(20), 1 / 120, 300, 3.0),
        Price("40 planks on pivots, on the floor", lambda: linkages.planks(40), 1 / 120, 300, 3.0),
        Price("cloth of 15 x 15 pins", linkages.cloth, 1 / 240, 10, 40.0),
        Price("heap, 200 bodies, 100 joints, falls", lambda: rods.heap().space, 1 / 60, 20, 20.0),
        Price("heap, settled", lambda: rods.heap().space, 1 / 60, 300, 20.0),
    ]


def price(one: Price, rounds: int = 15) -> Row:
    """What a step costs, each stepper in turn; medians of ratios of blocks that were run one after the other."""
    timed = {name: runner for name, (_, runner) in steppers(one.build).items()}
    scaling.interleave(timed, one.dt, one.warm, rounds)
    base, more, ours = (timed[name].seconds for name in (*(f"native {n}" for n in ITERATIONS), EECA))
    return {
        "scene": one.name, "dt (s)": one.dt, "native 10 (us)": 1e6 * timed["native 10"].median,
        "EECA (us)": 1e6 * timed[EECA].median,
        "EECA / native 10": statistics.median(a / b for a, b in zip(ours, base, strict=True)),
        "EECA / native 100": statistics.median(a / b for a, b in zip(ours, more, strict=True)),
        "may be": one.limit,
    }  # fmt: skip


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV and a picture."""
    ep.warmup()
    output.parameters({"iterations": ITERATIONS, "gap of the cradle (m)": rods.GAP, "full": full})
    found = problems()
    rows: list[Row] = []
    for problem in tqdm(found, desc="joints", unit="scene", disable=None):
        measure(problem, EECA, problem.dt)
        rows += curves(problem, BUDGET * (10.0 if full else 1.0))
    output.csv(rows, "all")
    output.table("EECA, and pymunk (at any dt) in no more time", [summary(p, rows) for p in found])
    output.table("Cost of a whole step at equal dt", [price(one) for one in tqdm(prices(), disable=None)], "cost")
    output.picture(picture(found, rows))


def picture(found: list[Problem], rows: list[Row]) -> Figure:
    """Error of places, and below it of the energy, against time: a column for each scene."""
    figure = render.figure(2.2 * len(found), 5.4)
    axes = figure.subplots(2, len(found), sharex="col", sharey="row", squeeze=False)
    for (top, low), problem in zip(axes.T, found, strict=True):
        for name, (colour, mark) in STYLE.items():
            mine = [r for r in rows if r["scene"] == problem.name and r["stepper"] == name]
            wall = [number(r, "time (ms)") for r in mine]
            for ax, column in ((top, "error (m)"), (low, "energy error")):
                values = np.maximum([number(r, column) for r in mine], FLOOR)
                ax.loglog(wall, values, f"{mark}-", color=colour, markersize=4, label=_LABEL.get(name, name))
        low.xaxis.set_minor_formatter(NullFormatter())
        top.set_title(problem.name)
        low.set_xlabel("time of all steps (ms)")
    axes[0, 0].set_ylabel("error of places (m)")
    axes[1, 0].set_ylabel("error of the energy (relative)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncol=len(STYLE), fontsize=9)
    return figure
