"""Print the tables of docs/parameters.md: `python -m eeca_pymunk.model.parameters`."""

from __future__ import annotations

from . import SECTIONS, table


def markdown() -> str:
    """One table for each section."""
    lines = []
    for section, parameters in zip(SECTIONS, table().values(), strict=True):
        lines += [f"### {section.__name__.rpartition('.')[2].capitalize()}", "", (section.__doc__ or "").strip(), ""]
        lines += ["| parameter | value | kind | scale | what it decides |", "|---|---|---|---|---|"]
        for name, p in parameters.items():
            texts = (t.replace("|", "\\|") for t in (p.kind, p.scale, p.effect))  # |a| is no border of a cell
            lines += [f"| `{name}` | {p.value:g} | {' | '.join(texts)} |"]
        lines += [""]
    return "\n".join(lines)


if __name__ == "__main__":
    print(markdown())
