"""`python -m eeca_pymunk.build`: compile the kernels to the library of these sources."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from ..compiled.backend import advice
from ..compiled.library import Status, load
from ..compiled.sources import builder_environment, cache_folder, library_folder, library_name, sources_hash, writable
from ..compiled.targets import TARGETS, this_platform

if TYPE_CHECKING:
    from .builder import Builder


def main(arguments: list[str] | None = None) -> int:
    """Build, and print what was built; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m eeca_pymunk.build", description=__doc__)
    parser.add_argument("--target", action="append", choices=[*TARGETS, "all"], help="platform, this one by default")
    parser.add_argument("--out", type=Path, help="folder; by default beside the sources")
    parser.add_argument("--workers", type=int, help="processes; by default one for each core, eight at most")
    parser.add_argument("--portable", action="store_true", help="for other machines too: linked by the ziglang wheel")
    parser.add_argument(
        "--object", action="store_true", help="an object file for this processor, in the place of a library"
    )
    parser.add_argument("--force", action="store_true", help="also if the library is there")
    options = parser.parse_args(arguments)
    names = list(TARGETS) if "all" in (options.target or ()) else options.target or [this_platform()]
    if unknown := [name for name in names if name not in TARGETS]:
        print(f"no library is built for {unknown[0]}, only for {', '.join(TARGETS)}", file=sys.stderr)
        return 2
    folder = (options.out or library_folder()).resolve()
    try:
        from .builder import Builder, one_build, remove_older
        from .workers import default_workers
    except ImportError as error:
        print(f"{error}. {advice()}", file=sys.stderr)
        return 2
    if options.object:
        return _object(Builder(cache_folder(), options.workers or default_workers(), True))
    with one_build(folder):
        here = folder / library_name()
        if (
            not options.force
            and names == [this_platform()]
            and load(here if here.is_file() else None)[0] is Status.LOADED
        ):
            print(f"{here} is there already; --force builds it again")
            return 0
        start = time.perf_counter()
        builder = Builder(folder, options.workers or default_workers(), True)
        try:
            built = builder.run(names, options.portable)
        except (RuntimeError, ImportError, OSError) as error:
            print(error, file=sys.stderr)
            return 1
    for path in built:
        print(f"{path}  {path.stat().st_size / 1e6:.2f} MB")
        remove_older(path)
    print("  ".join(f"{name} {seconds:.1f} s" for name, seconds in builder.seconds.items()))
    print(f"{time.perf_counter() - start:.1f} s in all")
    return 0


def _object(builder: Builder) -> int:
    """Write the object file of this processor, and print its path; returns the exit status."""
    folder = cache_folder() if writable(cache_folder()) else Path(tempfile.mkdtemp())
    path = folder / f"kernels-{sources_hash()[:16]}.o"
    try:
        path.write_bytes(builder.host_object())
    except (RuntimeError, ImportError, OSError) as error:
        print(error, file=sys.stderr)
        return 1
    print(path)
    return 0


if __name__ == "__main__":
    # numba iterates over sets of names in the order of their hashes: with random hashes two builds differ.
    # numba's settings, NUMBA_BOUNDSCHECK for instance, would change the code.
    others = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA_")}
    if sys.flags.hash_randomization or len(others) < len(os.environ):
        call = [sys.executable, "-m", "eeca_pymunk.build", *sys.argv[1:]]
        sys.exit(subprocess.run(call, env=builder_environment(others) | {"PYTHONHASHSEED": "0"}).returncode)
    sys.exit(main())
