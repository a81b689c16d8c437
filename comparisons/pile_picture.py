"""The picture of `piles`: what a step costs, and how deep bodies come into each other, against their number."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from comparisons.output import Row
from eeca_pymunk import render

# Rows of one stepper, kind and column, and how they are drawn.
COLOURS = {"EECA": "black", "native 10": "#D55E00"}
MARKS = {"disks": "o", "boxes": "s", "mixed": "d"}
FALLS, ENDS, DEEPEST = "x native 10", "at the end, x native", "deepest (r)"
TITLES = {FALLS: "falling step (x pymunk)", ENDS: "last steps (x pymunk)", DEEPEST: "deepest overlap (radii)"}


def draw(rows: list[Row]) -> Figure:
    """The largest over elasticity and friction. At the end, piles that rest are filled, those that still move open."""
    figure = render.figure(11.0, 4.0)
    counts = sorted({int(row["N"] or 0) for row in rows})
    for ax, (column, title) in zip(figure.subplots(1, len(TITLES)), TITLES.items(), strict=True):
        for kind, mark in MARKS.items():
            for stepper, colour in COLOURS.items():
                mine = [row for row in rows if row["kind"] == kind and row["stepper"] == stepper]
                look = {"color": colour, "marker": mark}
                if column == ENDS and stepper == "EECA":
                    ax.loglog(*_most([r for r in mine if r["still moving"]], column), ":", mfc="white", **look)
                    mine = [row for row in mine if not row["still moving"]]
                ax.loglog(*_most(mine, column), "-", label=f"{stepper}, {kind}", **look)
        ax.set(xlabel="bodies", title=title, xticks=counts, xticklabels=counts)
        ax.minorticks_off()
        ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        ax.yaxis.set_major_formatter("{x:g}")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside right upper", fontsize=8)
    figure.suptitle("Piles that fall and settle: the largest over elasticity and friction (open: bodies still move)")
    return figure


def _most(rows: list[Row], column: str) -> tuple[list[int], list[float]]:
    """Numbers of bodies, and the largest value of each."""
    found: dict[int, float] = {}
    for row in rows:
        count = int(row["N"] or 0)
        found[count] = max(found.get(count, 1e-12), float(row[column] or 0.0))
    return list(found), list(found.values())
