"""Where a comparison's results go: tables on the terminal, CSV and PNG in a folder."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from csv import DictWriter
from datetime import date
from pathlib import Path

from matplotlib.figure import Figure

from eeca_pymunk.files import check_writable, whole_file
from eeca_pymunk.recorder import versions
from eeca_pymunk.render import save_picture

Value = str | int | float | bool | None
Row = Mapping[str, Value]


class Output:
    """The results of one comparison. OSError if the folder cannot be written, before anything runs."""

    def __init__(self, name: str, folder: Path) -> None:
        self.name, self.folder = name, folder
        check_writable(self.path("csv"))
        self.made = f"{date.today().isoformat()}: " + ", ".join(f"{k} {v}" for k, v in versions().items())
        print(f"# {name}, {self.made}")

    def parameters(self, values: Mapping[str, object]) -> None:
        """Print the parameters of the runs that follow."""
        print("# " + ", ".join(f"{k} = {v}" for k, v in values.items()))

    def table(self, title: str, rows: Sequence[Row], file: str = "") -> None:
        """Print the rows as a table and write them to NAME[_file].csv."""
        columns = list(rows[0])
        cells = [columns] + [[as_text(row[c]) for c in columns] for row in rows]
        width = [max(len(line[i]) for line in cells) for i in range(len(columns))]
        print(f"\n{title}")
        for number, line in enumerate(cells):
            padded = [c.rjust(w) for c, w in zip(line, width, strict=True)]
            padded[0] = line[0].ljust(width[0])
            print("  ".join(padded).rstrip())
            if number == 0:
                print("  ".join("-" * w for w in width))
        self.csv(rows, file)

    def csv(self, rows: Sequence[Row], file: str = "") -> None:
        """Write the rows to NAME[_file].csv."""
        path = self.path("csv", file)
        with whole_file(path) as partial, partial.open("w", newline="") as stream:
            writer = DictWriter(stream, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)
        print(f"-> {path}")

    def picture(self, figure: Figure, file: str = "") -> None:
        """Write the figure to NAME[_file].png."""
        path = self.path("png", file)
        save_picture(figure, path)
        print(f"-> {path}")

    def path(self, suffix: str, file: str = "") -> Path:
        """The file of a result."""
        return self.folder / f"{self.name}{'_' if file else ''}{file}.{suffix}"


def as_text(value: Value) -> str:
    """A cell of a table: four digits, "-" where there is no value."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
