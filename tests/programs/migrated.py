"""Run an edited example of pymunk without a window: `python -m tests.programs.migrated FILE NAME FRAMES`.

Prints the number of our steps and of pymunk's own, the largest residual of the ledger, and what was damped.
"""

from __future__ import annotations

import random
import runpy
import sys
import warnings

import pymunk

import eeca_pymunk as ep
from comparisons.play import Clocked, Done, Hands, played

KEYS = ("f", *16 * ("",))  # newtons_cradle: lift some balls; flipper: hit with the left one


def main(file: str, name: str, frames: int) -> None:
    warnings.simplefilter("ignore")  # of pygame, which looks for fonts
    import pygame

    steps: list[ep.StepReport] = []
    scale: list[float] = []
    native, ours = pymunk.Space.step, ep.EECA.step

    def step(self: ep.EECA, dt: float) -> ep.StepReport:
        steps.append(ours(self, dt))
        now = ep.measure(self.space)
        scale.append(max(now.kinetic, abs(now.potential)))
        return steps[-1]

    ep.EECA.step = step  # type: ignore[method-assign]
    random.seed(1)
    hands = Hands(pygame, frames, KEYS)
    hands._posted = lambda *_: []  # no timers
    sys.argv = [name, "/i"]
    begun: list[float] = []
    clocked = Clocked("native")
    clocked.step = lambda space, dt: begun.append(dt) or native(space, dt)  # type: ignore[method-assign, func-returns-value]
    try:
        with played(pygame, hands, clocked):
            pygame.mouse.get_pressed = lambda *_: (False, False, False)
            hands.events = pygame.event.get = lambda *_: [e for e in Hands.events(hands) if e.type == pygame.KEYDOWN]  # type: ignore[method-assign]
            runpy.run_path(file, run_name="__main__")
    except (Done, SystemExit):
        pass
    residual = max(abs(s.ledger.residual) for s in steps if s.ledger is not None)
    loss = sum(s.ledger.damping + s.ledger.friction for s in steps if s.ledger is not None)
    print(len(steps), len(begun), residual / max(scale), loss)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
