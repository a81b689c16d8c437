"""Storing the arrays of a scene that steps change: as they were when new, as they are, and as a state has them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..arrays import AnyArray, FloatArray, IntArray
from ..compiled import Table, table_of
from ..compiled.records import Rows, as_integers, numbers, put
from ..energy.ledger import BOOK
from ..model.bodies import POSE, VELOCITY, Body
from ..model.contacts import Impulse
from ..model.joints import OF_JOINTS, Joint, Joints, joints_of
from ..model.scene import Scene, scene_of
from ..model.step import Count, Step
from ..pairs.setup import refilled
from ..report import Outcome
from .edits import edits_since, listed_by, values_of, write_edits
from .memory import GROWN_ARRAYS, OF_SCENE, gathered, recalled, remembered
from .scene_memory import SceneMemory

_STEP, _COUNT = Step.TYPE.names or (), Count.TYPE.names or ()
_LOCK, _STAMP = _STEP.index("lock"), _STEP.index("stamp")
_UNMET, _SOLVES, _BLOCKS, _LOGGED, _LOSSY = map(_COUNT.index, ("unmet", "solves", "blocks", "logged", "lossy"))
_IMPULSE = Impulse.TYPE.itemsize // 8
UNBOUND: tuple[Table, Callable[..., int]] = None, int
# Attributes that no copy has.
_OF_PROCESS = "table", "ties", "_bound", "own", "fresh", "_first", "_par", "_count", "log", "_book", "_memory"


class Remembering:
    """What an event loop stores of earlier steps.

    Attributes:
        log: the memory of LOG; another object once that is elsewhere.
        own, fresh: after `keep_fresh`, the memory of the arrays that steps change (`memory.OF_SCENE`), as integers, and
            a copy of it from before the first step, to which `reset_to` returns; empty before.
    """

    joint: Rows[Joint]
    partner: Rows[Body]
    table: Table = None
    own: IntArray
    fresh: IntArray = np.empty(0, np.int64)
    _memory: SceneMemory
    _listed: bool | None

    @property
    def jointed(self) -> bool:
        """Whether the scene has joints."""
        return len(self.joint) > 0

    @property
    def scene(self) -> Scene:
        """All arrays; replaced by setting another scene."""
        return scene_of(self.table)

    @scene.setter
    def scene(self, arrays: Scene) -> None:
        self.table = table_of(arrays)
        self._bound: tuple[Table, Callable[..., int]] = UNBOUND  # with the reading to which it is bound
        # These are read in every step. Fields of records take thirty times as long, entries of arrays three times.
        self._view(numbers(arrays.PAR).data, numbers(arrays.COUNT).data, as_integers(arrays.LOG).data)

    def _view(self, par: memoryview, count: memoryview, log: memoryview) -> None:
        """Use these as the memory of PAR, COUNT and LOG."""
        self._par, self._count, self.log, self._book = par, count, log, par[BOOK]

    @property
    def joints(self) -> Joints:
        """All arrays of joints, empty if the scene has none; replaced by setting others."""
        return joints_of(self.ties)

    @joints.setter
    def joints(self, arrays: Joints) -> None:
        self.ties = table_of(arrays)
        self._bound = UNBOUND

    def outcome(self) -> Outcome:
        """Of the last step; iterations are solves of islands and simultaneous impacts."""
        count = self._count
        book: list[float] = self._book.tolist()  # type: ignore[assignment]
        return book, self._par[_LOCK], count[_UNMET] == 0, count[_SOLVES] + count[_BLOCKS]

    @property
    def stamp(self) -> float:
        """The number of the last step."""
        return float(self._par[_STAMP])

    @property
    def impulses(self) -> int:
        """Number of impulses of the last step."""
        return int(self._count[_LOGGED])

    def logged(self) -> bytes:
        """The impulses of the last step: to copy arrays takes three times as long."""
        return self.log[: self._count[_LOGGED] * _IMPULSE].tobytes()

    def __getstate__(self) -> dict[str, object]:
        state = {key: value for key, value in self.__dict__.items() if key not in _OF_PROCESS}
        return {**state, "_arrays": (self.scene, self.joints)}

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        self._memory = SceneMemory()
        self.scene, self.joints = self.__dict__.pop("_arrays")

    def keep_fresh(self) -> None:
        """Before the first step: put what steps change, apart from poses and velocities, into one piece of memory, and
        copy this for `reset_to`."""
        if self.jointed:
            (self.scene, self.joints), self.own = gathered((self.scene, OF_SCENE), (self.joints, OF_JOINTS))
            self.joint = self.joints.JOINT
        else:
            (self.scene,), self.own = gathered((self.scene, OF_SCENE))
        self.fresh = self.own.copy()
        self._first, self._listed = self.table, None  # the table whose values `fresh` has

    @property
    def listed(self) -> bool:
        """Whether near lists depend on places of bodies; else all shapes are in all lists."""
        if self._listed is None:
            self._listed = bool(np.isfinite(self.scene.MARK["margin"]).any())
        return self._listed

    def reset_to(self, at: IntArray, state: FloatArray) -> None:
        """Return to the state of a new loop, after `keep_fresh`, with the poses and velocities `state` (b, 6) of the
        rows `at` (b,) of BODY."""
        if self.listed:
            BODY, moved = self.scene.BODY, self.scene.BODY[at]
            put(moved, state, *POSE, *VELOCITY)
            moved["since"] = 0.0
            BODY[at] = moved
        self.own[:] = self.fresh
        if self.table is not self._first:
            # The first arrays again, not larger ones: memory then grows at the same steps as in a new loop.
            first = scene_of(self._first)
            self.scene = self.scene._replace(**{name: getattr(first, name) for name in GROWN_ARRAYS})
            self._first = self.table
        self.scene.KEYS.fill(-1)
        if self.listed:
            table = refilled(self.table)  # near lists for the present places of bodies
            if table is self.table:
                self.fresh[:] = self.own
            else:
                self.scene = scene_of(table)
                self.keep_fresh()

    def remembered(self) -> list[AnyArray]:
        """All arrays that determine the next step, apart from the states exchanged with pymunk."""
        return [*remembered(self.scene), *values_of(self.scene), *listed_by(self.scene)]

    def recall(self, take: Callable[[Any, tuple[int, ...]], AnyArray]) -> bool:
        """Set the arrays of `remembered`; `take` returns the next one, for a dtype and a shape. Values of shapes and
        bodies remain the present ones, and count as edited where they differ. False if another scene is needed, since
        filters, radii or places of static shapes are others."""
        lossy = self._count[_LOSSY]
        self.scene = recalled(self.scene, take)
        self._count[_LOSSY] = lossy
        then = [take(now.dtype, now.shape) for now in values_of(self.scene)]
        write_edits(self.table, edits_since(self.scene, *then))
        self.fresh = self.fresh[:0]
        same = [bool((now == take(now.dtype, now.shape)).all()) for now in listed_by(self.scene)]
        return all(same)
