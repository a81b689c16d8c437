"""The matrix: every case under every stepper, with what it measured."""

from __future__ import annotations

import math
import time

import pymunk
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import eeca_pymunk as ep
from comparisons import pool, runs
from comparisons.output import Output, Row, as_text
from eeca_pymunk import render

from .case import CASES, Case


def columns() -> dict[str, runs.Make]:
    """The steppers of the matrix."""

    def hundred(space: pymunk.Space) -> ep.Stepper:
        space.iterations = 100
        return ep.Native(space)

    return {
        "TimeOfImpact": runs.eeca(ep.TimeOfImpact()),
        "Midstep": runs.eeca(ep.Midstep()),
        "Dashpot": runs.eeca(ep.Dashpot(1e6, 200.0)),
        "native 10": runs.native(),
        "native 100": hundred,
    }


def figure(one: Case, make: runs.Make) -> float | None:
    """The figure of a case; None where the stepper refuses the scene, infinity where it gives up."""
    try:
        return float(one.run(make))
    except ep.UnsupportedFeature:
        return None
    except (ValueError, ArithmeticError):
        return math.inf


def cell(place: tuple[str, str]) -> tuple[float | None, float]:
    """The figure of a case under a stepper, by their names, and the seconds that took."""
    name, stepper = place
    begun = time.perf_counter()
    found = figure(next(one for one in CASES if one.name == name), columns()[stepper])
    return found, time.perf_counter() - begun


def run(output: Output, full: bool, workers: int = 1) -> None:
    """Print the matrix and its costs; write CSV and PNG."""
    names = list(columns())
    output.parameters({"dt": "1/60 unless said", "Dashpot": "K = 1e6, xi = 200", "native": "slop .1, persistence 3"})
    ep.warmup()
    found = iter(pool.over(cell, [(one.name, name) for one in CASES for name in names], workers))
    rows: list[Row] = []
    costs: list[Row] = []
    for one in CASES:
        row: dict[str, str | float] = {"case": one.name, "figure": one.figure, "passes up to": one.limit}
        cost: dict[str, str | float | None] = {"case": one.name}
        for name in names:
            value, cost[name] = next(found)
            if value is None:
                row[name], cost[name] = "refused", None
            else:
                row[name] = f"{'pass' if value <= one.limit else 'FAIL'} {as_text(value)}"
        rows.append(row)
        costs.append(cost)
    output.table("Hard cases: each cell the measured figure", rows)
    output.table("What each took, scene and oracle included (s)", costs, "costs")
    passed = {name: sum(str(r[name]).startswith("pass") for r in rows) for name in names}
    print(f"passed of {len(rows)}: " + ", ".join(f"{name} {count}" for name, count in passed.items()))
    output.picture(_matrix(rows, names))


def _matrix(rows: list[Row], names: list[str]) -> Figure:
    picture = render.figure(9.5, 0.3 * len(rows) + 1.0)
    ax = picture.add_subplot()
    shades = {"pass": to_rgb("#56b4e9"), "FAIL": to_rgb("#d55e00"), "refused": to_rgb("#dddddd")}
    cells = [[str(row[name]).split() for name in names] for row in rows]
    ax.imshow([[shades[c[0]] for c in line] for line in cells], aspect="auto")
    for i, line in enumerate(cells):
        for j, c in enumerate(line):
            ax.text(j, i, " ".join(c), ha="center", va="center", fontsize=8)
    ax.set_xticks(range(len(names)), names)
    ax.set_yticks(range(len(rows)), [str(row["case"]) for row in rows])
    ax.xaxis.tick_top()
    return picture
