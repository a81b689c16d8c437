"""Every figure and table of the paper that a run can produce, beside the paper's numbers: GALLERY.md."""

from __future__ import annotations

import csv
import time
from collections.abc import Callable
from datetime import date
from importlib import import_module
from pathlib import Path
from string import Template

import numpy as np
from tqdm import tqdm

import scenes
from comparisons.hopper import SMALLEST, numerical_damping
from comparisons.output import Output, as_text
from eeca_pymunk.files import whole_file

PARTS = ("signorini", "carom", "cradle", "pool_break", "hopper")
_PAGE = Path(__file__).parent / "gallery.template.md"
_SHOWN: dict[str, tuple[str, tuple[str, ...], dict[str, tuple[str, ...]]]] = {
    # name in the template: CSV, columns, the values that choose rows
    "fig_1": ("signorini", ("stepper", "E before", "least E during", "E after"), {}),
    "figs_4_5": ("signorini_xi", ("xi", "gap (m)", "psi1", "psi2", "f_c (N)", "f'_c (N)", "dE p_c (J)", "dE f'_c (J)"),
                 {"xi": ("0.0", "4.0", "20.0", "80.0", "160.0")}),
    "carom": ("carom", ("stepper", "error (m)", "max |dE/E|", "dE/E at end", "max turn (deg)"),
              {"dt (s)": ("0.0025",)}),
    "table_ii": ("pool_break", ("stepper", "case", "Lx", "Ly", "E (J)", "asymmetry 5 ms (m)"), {}),
    "table_iii": ("cradle", ("stepper", "hypothesis", "a", "b", "c", "momentum", "energy"), {}),
    "orders": ("cradle_orders", ("K (N/m)", "variable", "power in a", "power in b, c"), {}),
    "hopper": ("hopper", ("stepper", "dt (s)", "max |dE/E|", "dE/E at end", "leaked", "overlap (r)", "x native"), {}),
}  # fmt: skip
# name in the text: CSV, column, the values that choose rows, how the largest value is written
_TOLD: dict[str, tuple[str, str, dict[str, str], Callable[[float], str]]] = {
    "closed_form": ("signorini_xi", "from closed form", {}, "{:.0e}".format),
    "carom_off": ("carom", "error (m)", {"stepper": "EECA Dashpot xi=200", "dt (s)": "0.0025"}, "{:.2g}".format),
    "deepest": ("hopper", "overlap (r)", {"stepper": "max dissipation", "dt (s)": "0.0025"}, "{:.2g}".format),
    "lost": ("hopper", "dE/E at end", {"stepper": "max dissipation", "dt (s)": str(SMALLEST)},
             lambda x: f"{-100.0 * x:.0f}"),
    "left": ("hopper", "leaked", {"stepper": "trapezoidal", "dt (s)": "0.0005"}, "{:.0f}".format),
}  # fmt: skip


def run(output: Output, full: bool) -> None:
    """Run the paper's comparisons into DIR/gallery, with all that --full adds, and write DIR/GALLERY.md."""
    folder = output.folder / output.name
    for name in tqdm(PARTS, desc="gallery", unit="part", disable=None):
        begun = time.perf_counter()
        import_module(f".{name}", __package__).run(Output(name, folder), True)
        print(f"{name}: {time.perf_counter() - begun:.0f} s")
    write_page(output)


def write_page(output: Output) -> None:
    """Write DIR/GALLERY.md from the results in DIR/gallery."""
    folder = output.folder / output.name
    shown = {key: table(folder / f"{file}.csv", columns, rows) for key, (file, columns, rows) in _SHOWN.items()}
    told = {
        key: text(max(float(row[column]) for row in _rows(folder / f"{file}.csv", {k: (v,) for k, v in rows.items()})))
        for key, (file, column, rows, text) in _TOLD.items()
    }
    hopper = scenes.build("hopper")
    told |= {key: str(hopper.parameters[key]) for key in ("layers", "columns")}
    told |= {"disks": str(len(hopper.bodies)), "damping": f"{float(numerical_damping(np.ones(1), 0.49, 1.0)[0]):.2f}"}
    page = output.folder / "GALLERY.md"
    text = Template(_PAGE.read_text(encoding="utf-8")).substitute(shown | told, dir=output.name, made=output.made)
    with whole_file(page) as partial:
        partial.write_text(text, encoding="utf-8")
    print(f"-> {page}")


def table(path: Path, columns: tuple[str, ...], rows: dict[str, tuple[str, ...]]) -> str:
    """The columns of a CSV, in the rows whose values are among `rows`, as a Markdown table; its command and date."""
    lines = [columns, ("---",) * len(columns)] + [tuple(_cell(r[c]) for c in columns) for r in _rows(path, rows)]
    cells = ["| " + " | ".join(c.replace("|", "\\|") for c in line) + " |" for line in lines]
    part = next(name for name in PARTS if path.stem.startswith(name))
    made = date.fromtimestamp(path.stat().st_mtime).isoformat()
    return "\n".join([*cells, "", f"`python -m comparisons {part} --full`, {made}"])


def _rows(path: Path, rows: dict[str, tuple[str, ...]]) -> list[dict[str, str]]:
    with path.open(newline="") as stream:
        return [r for r in csv.DictReader(stream) if all(r[key] in values for key, values in rows.items())]


def _cell(value: str) -> str:
    try:
        return as_text(float(value))
    except ValueError:
        return value or "–"
