"""Play one of pymunk's examples headless: `python -m comparisons.play NAME native|eeca FRAMES ANSWER.json`.

The example's own main loop runs; its window is SDL's dummy, its clock does not wait, and keys and mouse are made up:
keys are held for a while one after the other, the mouse moves in a circle and presses, drags and releases.
"""

from __future__ import annotations

import json
import math
import random
import runpy
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

import pymunk

import eeca_pymunk as ep

_HELD = 12  # frames for which a key is held
_IDLE = 6  # and none after it
# Not those that end an example (escape, q) or write pictures (p).
KEYS = (
    "RIGHT", "UP", "LEFT", "SPACE", "SPACE", "RIGHT", "DOWN", "d", "j", "f", "b", "c", "g", "k", "u", "w", "a", "z",
    "x",
)  # fmt: skip
# Of examples that end at these, or raise: pymunk's `copy_and_pickle` adds two views of shapes as if they were lists
# when the space bar is pressed; it saves, loads and starts anew at others.  "": no key.
KEYS_OF = {"copy_and_pickle": ("s", "l", "r", "s", "r", "l", "l"), "newtons_cradle": ("r", "f", *8 * ("",))}
ARGUMENTS = {"newtons_cradle": ("/i",)}  # without any it only tells how to call it


class Done(BaseException):
    """All frames are drawn; not an `Exception`, which an example may catch."""


class Clocked:
    """Times every step of every space, and reads the ledger of ours.

    Attributes:
        steps: processor times of the thread that steps (s).
        residual: largest of the ledger relative to the largest energy so far.
        unconverged: steps whose solver was cut short.
    """

    def __init__(self, solver: str) -> None:
        self.ours = solver == "eeca"
        self.steps: list[float] = []
        self.residual, self.unconverged, self._scale = 0.0, 0, 0.0
        self._steppers: dict[int, ep.Stepper] = {}
        self._native = pymunk.Space.step

    def step(self, space: pymunk.Space, dt: float) -> None:
        """In the place of `Space.step`."""
        clock = time.thread_time()
        if not self.ours:
            self._native(space, dt)
            self.steps.append(time.thread_time() - clock)
            return
        if id(space) not in self._steppers:
            self._steppers[id(space)] = ep.EECA(space)
        report = self._steppers[id(space)].step(dt)
        self.steps.append(time.thread_time() - clock)
        self.unconverged += not report.converged
        if (book := report.ledger) is not None:
            now = ep.measure(space)
            self._scale = max(self._scale, now.kinetic, abs(now.potential), abs(book.external))
            self.residual = max(self.residual, abs(book.residual) / max(self._scale, 1e-300))


class Stepping(Protocol):
    """What takes the steps of an example: `steps` has as many entries as were taken."""

    steps: list[float]

    def step(self, space: pymunk.Space, dt: float) -> None:
        """In the place of `Space.step`."""


class Hands:
    """The keys and the mouse of frame k."""

    def __init__(self, pygame: Any, frames: int, keys: tuple[str, ...]) -> None:
        self.pygame, self.frames, self.keys, self.k = pygame, frames, keys, 0
        self._posted = pygame.event.get
        self.key: int | None = None
        self.position = (0, 0)
        self.buttons = [False, False, False]

    def events(self, *_: object, **__: object) -> list[Any]:
        """What has happened since the last frame."""
        pg, k = self.pygame, self.k
        surface = pg.display.get_surface()
        w, h = surface.get_size() if surface is not None else (600, 600)
        last, phase = self.position, 2.0 * math.pi * k / 90.0
        self.position = round(w * (0.5 + 0.3 * math.cos(phase))), round(h * (0.5 + 0.3 * math.sin(phase)))
        moved = (self.position[0] - last[0], self.position[1] - last[1])
        found = [event for event in self._posted() if event.type >= pg.USEREVENT]
        found += [pg.event.Event(pg.MOUSEMOTION, pos=self.position, rel=moved, buttons=tuple(self.buttons))]
        turn, rest = divmod(k, _HELD + _IDLE)
        name = self.keys[turn % len(self.keys)]
        if rest == 0 and name:
            self.key = getattr(pg, f"K_{name}")
            found.append(pg.event.Event(pg.KEYDOWN, key=self.key, mod=0, unicode="", scancode=0))
        elif rest == _HELD and self.key is not None:
            found.append(pg.event.Event(pg.KEYUP, key=self.key, mod=0, unicode="", scancode=0))
            self.key = None
        # The left button is pressed, dragged and released, then the right one.
        button = 1 if (k // 40) % 2 == 0 else 3
        if k % 40 in (10, 30):
            down = k % 40 == 10
            self.buttons[button - 1] = down
            kind = pg.MOUSEBUTTONDOWN if down else pg.MOUSEBUTTONUP
            found.append(pg.event.Event(kind, pos=self.position, button=button, touch=False))
        return found

    def flip(self, *_: object) -> None:
        """A frame is drawn."""
        self.k += 1
        if self.k >= self.frames:
            raise Done

    def pressed(self) -> Any:
        """Which keys are held, by key."""
        hands = self

        class Pressed:
            def __getitem__(self, key: int) -> bool:
                return key == hands.key

        return Pressed()


class Watch:
    """A clock that does not wait."""

    def tick(self, *_: float) -> int:
        return 16

    tick_busy_loop = tick

    def get_fps(self) -> float:
        return 60.0

    def get_time(self) -> int:
        return 16


@contextmanager
def played(pygame: Any, hands: Hands, clocked: Stepping) -> Iterator[None]:
    """Within, examples see our hands, and their spaces our step."""

    def step(self: pymunk.Space, dt: float) -> None:
        clocked.step(self, dt)
        if hands.k == 0 and len(clocked.steps) >= hands.frames:  # an example that draws nothing
            raise Done

    pymunk.Space.step = step  # type: ignore[method-assign]
    pygame.event.get = hands.events
    pygame.display.flip = pygame.display.update = hands.flip
    pygame.key.get_pressed = hands.pressed
    pygame.key.get_mods = lambda: 0
    pygame.mouse.get_pos = lambda: hands.position
    pygame.mouse.get_pressed = lambda *_: tuple(hands.buttons)
    pygame.time.Clock, pygame.time.get_ticks = Watch, lambda: 16 * hands.k
    yield


def main(arguments: list[str]) -> int:
    """Run the command line; the exit status."""
    import pygame

    name, solver, frames, answer = arguments[0], arguments[1], int(arguments[2]), Path(arguments[3])
    if solver == "eeca":
        ep.warmup()
    random.seed(1)
    hands, clocked = Hands(pygame, frames, KEYS_OF.get(name, KEYS)), Clocked(solver)
    says = "runs"
    sys.argv = [name, *ARGUMENTS.get(name, ())]
    try:
        with played(pygame, hands, clocked):
            runpy.run_module(f"pymunk.examples.{name}", run_name="__main__", alter_sys=True)
    except (Done, SystemExit):
        pass
    except ep.UnsupportedFeature as error:
        says = f"refused: {_what(str(error))}"
    except Exception as error:
        says = f"{type(error).__name__}: {error}".splitlines()[0]
    picture = ""
    surface = pygame.display.get_surface() if pygame.display.get_init() else None
    if surface is not None:
        picture = str(answer.with_suffix(".png"))
        pygame.image.save(surface, picture)
    later = [1e3 * t for t in clocked.steps[1:]]
    found = {
        "says": says,
        "steps": len(clocked.steps),
        "mean": sum(later) / len(later) if later else None,
        "worst": max(later) if later else None,
        "residual": clocked.residual if clocked.ours else None,
        "unconverged": clocked.unconverged if clocked.ours else None,
        "picture": picture,
    }
    answer.write_text(json.dumps(found))
    return 0


def _what(message: str) -> str:
    """What of a scene is refused, in a word."""
    return next((word for word in ("sleeping", "constraints") if word in message), message[:40])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
