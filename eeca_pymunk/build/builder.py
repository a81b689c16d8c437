"""The stages of a build: compile kernels, join them to modules, optimise, write machine code, link."""

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
from ..compiled.frontend.module import Group
from ..compiled.frontend.parts import Part
from ..compiled.sources import cache_folder, library_name, sources_hash
from ..compiled.targets import TARGETS, Target, linker
from .workers import Workers, all_parts, import_kernels

_MACHINE_CODE = 150  # weight of machine code of one platform in the progress bar, in parts
_SMALL = 5000  # bytes of code up to which a kernel is copied into other modules that call it, to be inlined
_KEPT = 6  # libraries of other sources that are left beside the newest


class Builder:
    """A build of libraries for some platforms.

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
        """Show the name of a stage, and measure its time."""
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
        with self._bar, Workers(self.workers) as workers:
            calls, found = self._parts(workers, _MACHINE_CODE * len(names))
            groups = two_groups(calls, found)
            check_unchanged()
            built = []
            for name in names:
                target = TARGETS[name]
                with self.stage(f"optimising, writing machine code for {name}"):
                    objects = self._objects(workers, groups, target)
                    self._bar.update(_MACHINE_CODE)
                with self.stage(f"linking for {name}"):
                    built.append(link(self.folder / library_name(name), objects, linker(name, portable)))
        store.prune()
        return built

    def host_object(self) -> bytes:
        """Machine code of all kernels for this processor, as one object file to be loaded into a process."""
        with self._bar, Workers(self.workers) as workers:
            calls, found = self._parts(workers, _MACHINE_CODE)
            order = sorted(found, key=symbol)
            group = Group(
                [(name, found[call].returned) for name, call in calls.items()], [found[c].bitcode for c in order]
            )
            check_unchanged()
            with self.stage("optimising, writing machine code for this processor"):
                key = store.group_key(group, "this process", module.host())
                code = store.read("objects", key)
                if code is None:
                    code = module.host_object_of(group)
                    store.write("objects", key, code)
        return code

    def _parts(self, workers: Workers, after: int) -> tuple[dict[str, Call], dict[Call, Part]]:
        """The calls of all entries, and the parts of these and of all that they call; `after`: weight of what follows
        in the progress bar."""
        with self.stage("compiling kernels"):
            import_kernels()
            calls = {name: module.entry_call(name) for name in ENTRIES}
            return calls, all_parts(calls.values(), workers, lambda done, known: self._show(done, known + after))

    def _show(self, done: int, total: int) -> None:
        self._bar.total, self._bar.n = total, done
        self._bar.refresh()

    @staticmethod
    def _objects(workers: Workers, groups: list[Group], target: Target) -> list[bytes]:
        """The object files of a platform, from the store or compiled."""
        keys = [store.group_key(one, target.triple, target.cpu) for one in groups]
        found = [store.read("objects", key) for key in keys]
        lacking = [i for i, code in enumerate(found) if code is None]
        made = workers.objects([groups[i] for i in lacking], target.triple, target.cpu)
        for i, code in zip(lacking, made, strict=True):
            store.write("objects", keys[i], code)
            found[i] = code
        return [*filter(None, found), module.marked_object(sources_hash(), target.triple, target.cpu)]


def check_unchanged() -> None:
    """RuntimeError if the sources were edited since this process imported them."""
    if sources_hash.__wrapped__() != sources_hash():
        raise RuntimeError("sources were edited during the build: build again")


def two_groups(calls: dict[str, Call], found: dict[Call, Part]) -> list[Group]:
    """Two modules, that of joints and that of all other kernels, which are optimised in parallel.

    Small kernels of one module that the other one calls are copied into it, to be inlined; a call of a larger kernel is
    cheap compared with the kernel.
    """
    order = sorted(found, key=symbol)
    jointed = {call for call in order if call[0].name.startswith(("newton.", "joints.", "jointed."))}
    sides = [[call for call in order if (call in jointed) == side] for side in (False, True)]
    copies = [_copies(side, found) for side in sides]
    whole = [[call for call in order if call in {*side, *copied}] for side, copied in zip(sides, copies, strict=True)]
    here = [{symbol(call) for call in side} for side in whole]
    called = [{symbol(callee) for call in side for callee in found[call].calls} for side in whole]
    return [
        Group(
            entries=[(name, found[call].returned) for name, call in calls.items() if call in set(sides[i])],
            parts=[found[call].bitcode for call in whole[i]],
            public=frozenset({symbol(call) for call in sides[i]} & (called[1 - i] - here[1 - i])),
            foreign=frozenset(called[i] - here[i]),
        )
        for i in (0, 1)
    ]


def _copies(side: list[Call], found: dict[Call, Part]) -> set[Call]:
    """The small kernels of the other side that this side calls, directly or through each other."""
    own, copied, waiting = set(side), set[Call](), list(side)
    while waiting:
        for callee in found[waiting.pop()].calls:
            if (
                callee not in own
                and callee not in copied
                and (callee[0].inlined or len(found[callee].bitcode) <= _SMALL)
            ):
                copied.add(callee)
                waiting.append(callee)
    return copied


def link(path: Path, objects: list[bytes], command: list[str]) -> Path:
    """Link these object files into a shared library; its file appears when it is complete."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".link") as place:
        names = [f"{number}.o" for number in range(len(objects))]
        for name, code in zip(names, objects, strict=True):
            Path(place, name).write_bytes(code)
        plain = ["-Wl,--build-id=none"] if path.suffix == ".so" else []
        # The ziglang linker caches what it compiles of the C library; a user may have no home folder for that.
        environment = {"ZIG_GLOBAL_CACHE_DIR": str(cache_folder() / "zig")} | os.environ
        done = subprocess.run(
            [*command, "-shared", "-s", *plain, "-o", path.name, *names, "-lm"],
            cwd=place,
            env=environment,
            capture_output=True,
            text=True,
        )
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)} failed:\n{done.stderr}")
        os.replace(Path(place, path.name), path)
    return path


def remove_older(path: Path) -> None:
    """Keep the `_KEPT` newest libraries of other sources, for switching between branches, and remove older ones."""
    ending = path.name.split("-", 2)[2]
    others = sorted(path.parent.glob(f"kernels-*-{ending}"), key=lambda p: p.stat().st_mtime, reverse=True)
    for old in [p for p in others if p != path][_KEPT:]:
        old.unlink(missing_ok=True)


@contextmanager
def one_build(folder: Path) -> Iterator[None]:
    """Wait until no other process of this machine builds into this folder."""
    try:
        import fcntl
    except ImportError:  # two builds at once then do the same work, and write the same file
        yield
        return
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / ".lock", "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
