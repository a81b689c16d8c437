"""`python -m comparisons` lists the comparisons; `python -m comparisons NAME [--out DIR]` runs one."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from .output import Output

NAMES = ("signorini", "carom", "cradle", "pool_break", "hopper", "work_precision", "scaling", "soak")


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m comparisons", description="Run a comparison of time steppers.")
    parser.add_argument("name", nargs="?", help="the comparison; none lists them")
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder for CSV and PNG (default: out)")
    parser.add_argument("--full", action="store_true", help="also the runs that take minutes each")
    options = parser.parse_args(arguments)
    if options.name is None:
        for name in NAMES:
            title = (import_module(f".{name}", __package__).__doc__ or "").splitlines()[0]
            print(f"{name:12} {title}")
        print("\nRun one with: python -m comparisons NAME --out DIR")
        return 0
    try:
        if options.name not in NAMES:
            raise ValueError(f"unknown comparison {options.name!r}: choose one of {', '.join(NAMES)}")
        output = Output(options.name, options.out)
    except (ValueError, OSError) as error:
        print(f"python -m comparisons: {error}", file=sys.stderr)
        return 2
    run: Callable[[Output, bool], None] = import_module(f".{options.name}", __package__).run
    run(output, options.full)
    return 0


if __name__ == "__main__":
    sys.exit(main())
