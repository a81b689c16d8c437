"""Sleeping: what a step of a pile of boxes costs that sleeps, beside pymunk's; and what wakes when it is touched.

A thousand boxes in stacks of ten fall asleep by themselves, under both. Time is that of this process, in turn. Then a
ball hits one of the stacks: it wakes within that step, the others sleep on.
"""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass, field

import pymunk

import eeca_pymunk as ep
from comparisons import scaling
from comparisons.output import Output, Row
from scenes.scene import add_box, add_disk, add_walls

DT, G = 1 / 60, 9.81
BOXES, HIGH = 1000, 10
THRESHOLD = 0.5  # s of rest
PATIENCE = 600  # steps after which who is awake does not fall asleep
ROUNDS = 15
NAMES = ("native", "EECA, sync", "EECA")


def pile(boxes: int = BOXES, high: int = HIGH) -> pymunk.Space:
    """Unit boxes in stacks, 2 m apart, in a space whose bodies may sleep."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -G), THRESHOLD
    add_walls(space, [((-5.0, 0.0), (2.0 * boxes / high + 5.0, 0.0))])
    for k in range(boxes):
        add_box(space, (2.0 * (k // high), 0.5 + k % high), 1.0, 1.0)
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.0, 0.7
    if boxes >= scaling.HASH_FROM:
        space.use_spatial_hash(1.5, 2 * boxes)
    return space


def sleepers(space: pymunk.Space) -> int:
    """How many bodies sleep."""
    return sum(body.is_sleeping for body in space.bodies)


@dataclass
class Track:
    """One stepper on its own pile: the seconds of its steps awake, and of blocks of steps asleep."""

    name: str
    space: pymunk.Space
    runner: scaling.Runner
    awake: list[float] = field(default_factory=list)

    def settle(self) -> int:
        """Steps until all sleep, or PATIENCE."""
        while sleepers(self.space) < len(self.space.bodies) and len(self.awake) < PATIENCE:
            begin = time.process_time()
            self.runner.step(DT)
            self.awake.append(time.process_time() - begin)
        for _ in range(int(self.space.collision_persistence) + 2):
            self.runner.step(DT)
        return len(self.awake)

    def hit(self) -> Row:
        """A ball that falls on the first stack: who wakes, and in which step."""
        before = sleepers(self.space)
        top = max(body.position.y for body in self.space.bodies) + 0.5
        ball = add_disk(self.space, (0.2, top + 0.7), 0.3, 2.0, (0.0, -5.0))
        step = woken = 0
        struck = False
        while not struck and not woken and step < PATIENCE:
            speed = ball.velocity.y
            self.runner.step(DT)
            struck, woken, step = ball.velocity.y > speed, before - sleepers(self.space), step + 1
        return {"stepper": self.name, "slept": before, "ball is hit in step": step, "woken in it": woken}


def tracks(boxes: int, high: int) -> list[Track]:
    """pymunk, and EECA with and without sync."""
    found = []
    for name in NAMES:
        space = pile(boxes, high)
        step = space.step if name == "native" else ep.EECA(space, sync=name.endswith("sync")).step
        found.append(Track(name, space, scaling.Runner(step)))
    return found


def case(boxes: int = BOXES, high: int = HIGH, rounds: int = ROUNDS) -> tuple[list[Row], list[Row]]:
    """Costs of the steppers awake and asleep, and what a hit wakes."""
    runs = tracks(boxes, high)
    settled = {run.name: run.settle() for run in runs}
    slept = {run.name: sleepers(run.space) for run in runs}
    scaling.interleave({run.name: run.runner for run in runs}, DT, scaling.WARM, rounds)
    base = runs[0].runner.seconds
    rows: list[Row] = []
    for run in runs:
        rows.append({
            "stepper": run.name, "boxes": boxes, "asleep": slept[run.name], "after (steps)": settled[run.name],
            "awake (us/step)": 1e6 * statistics.mean(run.awake), "asleep (us/step)": 1e6 * run.runner.median,
            "asleep, x native": statistics.median(a / b for a, b in zip(run.runner.seconds, base, strict=True)),
        })  # fmt: skip
    return rows, [run.hit() for run in runs]


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV."""
    ep.warmup()
    output.parameters({"dt": DT, "boxes": BOXES, "stacks of": HIGH, "threshold (s)": THRESHOLD})
    costs, hits = case()
    output.table("A pile that sleeps", costs)
    output.table("A ball falls on one of its stacks", hits, "hit")
