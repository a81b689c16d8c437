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

_SHADES = {"pass": "#56b4e9", "FAIL": "#d55e00", "refused": "#dddddd"}


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
    half = -(-len(rows) // 2)
    picture = render.figure(16.0, 0.21 * half + 0.8)
    for ax, part in zip(picture.subplots(1, 2), (rows[:half], rows[half:]), strict=True):
        cells = [[str(row[name]).split() for name in names] for row in part]
        ax.imshow([[to_rgb(_SHADES[c[0]]) for c in line] for line in cells], aspect="auto")
        for i, line in enumerate(cells):
            for j, c in enumerate(line):
                ax.text(j, i, _short(c), ha="center", va="center", fontsize=8)
        ax.set_xticks(range(len(names)), names)
        ax.set_yticks(range(len(part)), [str(row["case"]) for row in part], fontsize=9)
        ax.xaxis.tick_top()
        # Both halves have rows of one height.
        ax.set_ylim(half - 0.5, -0.5)
        ax.spines[:].set_visible(False)
    return picture


def _short(cell: list[str]) -> str:
    """A figure of two digits, with a word if it does not pass."""
    if cell[0] == "refused":
        return "refused"
    value = float(cell[1])
    return f"{'' if cell[0] == 'pass' else 'FAIL '}{value:{'.0f' if 10.0 <= value < 1e5 else '.2g'}}"
