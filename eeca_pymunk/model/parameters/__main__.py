"""Print the tables of docs/parameters.md: `python -m eeca_pymunk.model.parameters`."""

from __future__ import annotations

from . import SECTIONS, table


def markdown() -> str:
    """One table for each section."""
    lines = []
    for section, parameters in zip(SECTIONS, table().values(), strict=True):
        lines += [f"### {section.__name__.rpartition('.')[2].capitalize()}", "", (section.__doc__ or "").strip(), ""]
        lines += ["| parameter | value | kind | scale | what it decides |", "|---|---|---|---|---|"]
        lines += [f"| `{n}` | {p.value:g} | {p.kind} | {p.scale} | {p.effect} |" for n, p in parameters.items()]
        lines += [""]
    return "\n".join(lines)


if __name__ == "__main__":
    print(markdown())
