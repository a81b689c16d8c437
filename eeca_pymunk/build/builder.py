"""The stages of a build: compile kernels, put them together, optimise, write machine code, link."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tqdm import tqdm

from ..compiled.entries import ENTRIES
from ..compiled.frontend import module, store
from ..compiled.frontend.calls import Call, symbol
from ..compiled.frontend.parts import Part
from ..compiled.sources import library_name, sources_hash
from ..compiled.targets import TARGETS, linker
from .workers import gather, import_kernels

# What a bar counts of the stages after the first, in parts compiled in the same time.
_LINKING, _OPTIMISING, _WRITING = 15, 160, 80
_KEPT = 6  # libraries of other sources that are left beside the newest


class Builder:
    """One build, of a library for each of some platforms.

    Args:
        folder: where libraries go.
        workers: processes that compile kernels.
        progress: show a bar on standard error.
    """

    def __init__(self, folder: Path, workers: int, progress: bool) -> None:
        self.folder, self.workers = folder, workers
        self.seconds: dict[str, float] = {}
        self._bar: Any = tqdm(
            total=len(ENTRIES), unit="part", disable=None if progress else True, file=sys.stderr, leave=False,
            bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}",
        )  # fmt: skip

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Name what is being done, and note how long it takes."""
        self._bar.set_description_str(name)
        start = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start

    def run(self, names: list[str], portable: bool) -> list[Path]:
        """Build the libraries of these platforms.

        Args:
            portable: for other machines of the platform too; see `compiled.targets.linker`.

        Raises:
            RuntimeError: there is no linker for one of them, or it fails.
        """
        for name in names:
            if not linker(name, portable):
                raise RuntimeError(f"no linker for {name}: pip install ziglang")
        with self._bar:
            with self.stage("compiling kernels"):
                import_kernels()
                calls = {name: module.entry_call(name) for name in ENTRIES}
                after = _LINKING + (_OPTIMISING + _WRITING) * len(names)
                found = gather(calls.values(), self.workers, lambda done, known: self._show(done, known + after))
            order = sorted(found, key=symbol)
            key = store.digest(sorted(map(store.part_key, order)), module_sources())
            built = [self._library(name, portable, key, calls, found, order) for name in names]
        store.prune()
        return built

    def _show(self, done: int, total: int) -> None:
        self._bar.total, self._bar.n = total, done
        self._bar.refresh()

    def _library(
        self, name: str, portable: bool, key: str, calls: dict[str, Call], found: dict[Call, Part], order: list[Call]
    ) -> Path:
        target = TARGETS[name]
        machine = module.machine_of(target.triple, target.cpu)
        key = store.digest(key, target.triple, target.cpu)
        code = store.read("objects", key)
        if code is None:
            with self.stage(f"{name}: putting {len(order)} kernels together"):
                entries = {entry: (call, found[call].returned) for entry, call in calls.items()}
                whole = module.retargeted(module.linked(entries, (found[one].bitcode for one in order)), machine)
                self._bar.update(_LINKING)
            with self.stage(f"{name}: optimising"):
                module.optimise(whole, machine)
                self._bar.update(_OPTIMISING)
            with self.stage(f"{name}: writing machine code"):
                code = bytes(machine.emit_object(whole))
                self._bar.update(_WRITING)
            store.write("objects", key, code)
        with self.stage(f"{name}: linking"):
            mark = machine.emit_object(module.retargeted(module.mark(sources_hash()), machine))
            return link(
                self.folder / library_name(name), {"kernels.o": code, "sources.o": mark}, linker(name, portable)
            )


def module_sources() -> str:
    """What the module is made by, beside its parts."""
    return store.digest(*(p.read_bytes() for p in sorted(Path(module.__file__).parent.glob("*.*")) if p.is_file()))


def link(path: Path, objects: dict[str, bytes], command: list[str]) -> Path:
    """Link these object files into a shared library, which takes its place when it is complete."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".link") as place:
        for name, code in objects.items():
            Path(place, name).write_bytes(code)
        plain = ["-Wl,--build-id=none"] if path.suffix == ".so" else []
        done = subprocess.run(
            [*command, "-shared", "-s", *plain, "-o", path.name, *objects, "-lm"],
            cwd=place,
            capture_output=True,
            text=True,
        )
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)} failed:\n{done.stderr}")
        os.replace(Path(place, path.name), path)
    return path


def remove_older(path: Path) -> None:
    """Leave some libraries of other sources, for those who go back and forth between them, and remove the rest."""
    ending = path.name.split("-", 2)[2]
    others = sorted(path.parent.glob(f"kernels-*-{ending}"), key=lambda p: p.stat().st_mtime, reverse=True)
    for old in [p for p in others if p != path][_KEPT:]:
        old.unlink(missing_ok=True)


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Wait until no other process of this machine builds into this folder."""
    try:
        import fcntl
    except ImportError:  # two builds at once then do the same work twice, and leave the same file
        yield
        return
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / ".lock", "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
