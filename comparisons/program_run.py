"""Run one program in a process of its own: `python -m comparisons.program_run NAME SOLVER FRAMES ANSWER.json`.

SOLVER is native, eeca, or parts: eeca with clocks around its parts. NAME is one of pymunk's examples, which run as in
`play`, or of `program_scenes`.
"""

from __future__ import annotations

import gc
import hashlib
import json
import random
import runpy
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pymunk

import eeca_pymunk as ep
from eeca_pymunk.impacts.scene import EventLoop
from eeca_pymunk.packed_space import PackedSpace
from eeca_pymunk.space.hooks import Hooks
from eeca_pymunk.space.late_shapes import Late
from eeca_pymunk.space.rehearsal import Rehearsal
from eeca_pymunk.space.sync import Sync

from .play import ARGUMENTS, KEYS, KEYS_OF, Done, Hands, played
from .program_scenes import PROGRAMS

# What each part of a step is, by the methods in which it is spent; a part has not what parts within it have.
PARTS: dict[str, tuple[tuple[type, str], ...]] = {
    "kernel": ((EventLoop, "step"),),
    "re-reads": ((PackedSpace, "_update_world"),),
    "sync": ((Sync, "end"), (Sync, "leave_late"), (Sync, "call_back"), (Late, "move")),
    "handlers": (
        (Rehearsal, "run"), (Rehearsal, "rules"), (Sync, "finish_rehearsal"), (Hooks, "velocity_changes"),
        (Hooks, "before"), (Hooks, "after"), (Hooks, "positions"),
    ),
}  # fmt: skip


class Run:
    """Steps every space of a program, and keeps what each step took and where it led.

    Attributes:
        steps: processor times of the thread that steps (s).  parts: those of parts of all steps (s).
        calls: of collision handlers.  reads: whole spaces read anew after the first time.
    """

    def __init__(self, solver: str) -> None:
        self.ours, self.inspected = solver != "native", solver == "parts"
        self.steps: list[float] = []
        self.parts = dict.fromkeys(PARTS, 0.0)
        self.calls = 0
        self._path = hashlib.sha256()
        self._steppers: dict[int, ep.EECA] = {}
        self._first = 0  # objects that were read when steppers were made
        self._native = pymunk.Space.step
        self._within: list[float] = []
        self._stepping = False
        if self.inspected:
            for part, methods in PARTS.items():
                for owner, name in methods:
                    self._clock(owner, name, part)
        self._count_late()

    def step(self, space: pymunk.Space, dt: float) -> None:
        """In the place of `Space.step`."""
        if not self.steps:
            # What was made while there were no collections is as old as it would be otherwise: young collections do not
            # go through it.
            gc.freeze()
            gc.unfreeze()
        gc.enable()
        self._stepping = True
        begun = time.thread_time()
        if not self.ours:
            self._native(space, dt)
        else:
            stepper = self._steppers.get(id(space))
            if stepper is None:
                stepper = self._steppers[id(space)] = ep.EECA(space)
                self._first += stepper.objects_read
            stepper.step(dt)
        self.steps.append(time.thread_time() - begun)
        self._stepping = False
        if len(self.steps) == 1:
            self.parts = dict.fromkeys(PARTS, 0.0)
        for body in space.bodies:
            self._path.update(repr((body.position, body.angle)).encode())

    def _count_late(self) -> None:
        """Count what shapes take that are moved when the program reads them to the step before."""
        move = Late.move

        def counted(late: Late, space: pymunk.Space) -> None:
            begun = time.thread_time()
            move(late, space)
            if self.steps and not self._stepping:
                self.steps[-1] += time.thread_time() - begun

        Late.move = counted  # type: ignore[method-assign, assignment]

    def hear(self) -> None:
        """Count the calls of collision handlers that programs set from now on."""
        native: Any = pymunk.Space.on_collision

        def on_collision(space: pymunk.Space, *types: Any, **functions: Any) -> None:
            for phase in ("begin", "pre_solve", "post_solve", "separate"):
                if functions.get(phase) is not None:
                    functions[phase] = self._counted(functions[phase])
            native(space, *types, **functions)

        pymunk.Space.on_collision = on_collision  # type: ignore[method-assign, assignment]

    def _counted(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            self.calls += 1
            return function(*arguments)

        return call

    def _clock(self, owner: type, name: str, part: str) -> None:
        method, within = vars(owner)[name], self._within

        def timed(*arguments: Any, **options: Any) -> Any:
            begun = time.thread_time()
            within.append(0.0)
            try:
                return method(*arguments, **options)
            finally:
                took = time.thread_time() - begun
                self.parts[part] += took - within.pop()
                if within:
                    within[-1] += took

        setattr(owner, name, timed)

    def told(self) -> dict[str, Any]:
        """What the run was."""
        later, steppers = self.steps[1:], self._steppers.values()
        return {
            "steps": later, "calls": self.calls, "path": self._path.hexdigest()[:8],
            "reads": sum(stepper.reads - 1 for stepper in steppers),
            "patches": sum(stepper.patches for stepper in steppers),
            "objects": sum(stepper.objects_read for stepper in steppers) - self._first,
            "parts": {part: taken / max(len(later), 1) for part, taken in self.parts.items()},
        }  # fmt: skip


def example(name: str, frames: int, run: Run) -> None:
    """Play one of pymunk's examples."""
    import pygame

    random.seed(1)
    sys.argv = [name, *ARGUMENTS.get(name, ())]
    hands = Hands(pygame, frames, KEYS_OF.get(name, KEYS))
    try:
        with played(pygame, hands, run):
            runpy.run_module(f"pymunk.examples.{name}", run_name="__main__", alter_sys=True)
    except (Done, SystemExit):
        pass


def scene(name: str, frames: int, run: Run) -> None:
    """Step one of `program_scenes`."""
    space, dt, before = PROGRAMS[name]()
    for k in range(frames):
        before(k)
        run.step(space, dt)


def main(arguments: list[str]) -> int:
    """Run the command line; the exit status."""
    name, solver, frames, answer = arguments[0], arguments[1], int(arguments[2]), Path(arguments[3])
    if solver != "native":
        ep.warmup()
    run, says = Run(solver), "runs"
    if solver == "parts":
        run.hear()
    gc.disable()  # until the first step: copy_and_pickle has a body that is lost where a collection happens to follow
    try:
        (scene if name in PROGRAMS else example)(name, frames, run)
    except Exception as error:
        says = f"{type(error).__name__}: {error}".splitlines()[0]
    answer.write_text(json.dumps({"says": says, **run.told()}))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
