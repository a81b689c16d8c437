"""Every figure and table of the paper that a run can produce, beside the paper's numbers: GALLERY.md."""

from __future__ import annotations

import csv
from importlib import import_module
from pathlib import Path
from string import Template

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


def run(output: Output, full: bool) -> None:
    """Run the paper's comparisons into DIR/gallery, and write DIR/GALLERY.md."""
    folder = output.folder / output.name
    for name in PARTS:
        import_module(f".{name}", __package__).run(Output(name, folder), full)
    write_page(output)


def write_page(output: Output) -> None:
    """Write DIR/GALLERY.md from the results in DIR/gallery."""
    folder = output.folder / output.name
    tables = {key: table(folder / f"{file}.csv", columns, rows) for key, (file, columns, rows) in _SHOWN.items()}
    page = output.folder / "GALLERY.md"
    text = Template(_PAGE.read_text(encoding="utf-8")).substitute(tables, dir=output.name, made=output.made)
    with whole_file(page) as partial:
        partial.write_text(text, encoding="utf-8")
    print(f"-> {page}")


def table(path: Path, columns: tuple[str, ...], rows: dict[str, tuple[str, ...]]) -> str:
    """The columns of a CSV, in the rows whose values are among `rows`, as a Markdown table."""
    with path.open(newline="") as stream:
        found = [r for r in csv.DictReader(stream) if all(r[key] in values for key, values in rows.items())]
    lines = [columns, ("---",) * len(columns)] + [tuple(_cell(r[c]) for c in columns) for r in found]
    return "\n".join("| " + " | ".join(c.replace("|", "\\|") for c in line) + " |" for line in lines)


def _cell(value: str) -> str:
    try:
        return as_text(float(value))
    except ValueError:
        return value or "–"
