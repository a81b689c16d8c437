"""The memory of an event loop's arrays, used again by the loop of the next reading of the space."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray, Memory
from ..compiled import Table, table_of
from ..compiled.records import Rows, rows
from ..geometry.corners import side_rows
from ..joints.workspace import make_joints
from ..model.bodies import Body, Member, Next, Rest
from ..model.contacts import Force, Impulse, Pair, Pushed
from ..model.joints import Held, Joint, Joints
from ..model.scene import Scene
from ..model.shapes import Corner, Link, Shape, Side
from ..model.step import Count, Missed, Step
from ..pairs.setup import NEAR, NO_GRID, filled, near_sizes
from .memory import OF_SCENE
from .new_scene import MEASURES, begin_scene, measure_scene

RULE_COLUMNS = 6
ORDER = 4  # of the steps of components without dissipation, drives and contacts
_MISSED = 32  # rows of MISSED: those reported of a step
_CONTACTS = 256  # rows of PUSHED at first, a power of 2
_OF_A_BODY, _MANY = 32, 1 << 16  # rows for each body where contacts may persist, and all rows at most at first
_NO_RULE: FloatArray = np.zeros((0, RULE_COLUMNS))


class SceneMemory:
    """Memory for the scenes of one stepper: each replaces the one before, whose arrays it overwrites.

    Attributes:
        own: the memory of the arrays of the last scene that `OF_SCENE` names, as integers; None if some are elsewhere.
    """

    own: IntArray | None = None

    def __init__(self) -> None:
        self._memory = Memory()
        self._sizes: IntArray = np.zeros(MEASURES, np.int64)
        self._rows: dict[str, Any] = {}
        self._unjointed: tuple[Joints, Table] | None = None

    def scene(
        self, BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, HELD: Rows[Held]
    ) -> tuple[Scene, Table]:
        """The arrays of a scene that has taken no step, and their table; those given are kept, not copied."""
        n, k = len(BODY), len(LINK)
        measure_scene(SHAPE, LINK, VERTEX, self._sizes, n - 1)
        moving, corners, thin, lossy = self._sizes.tolist()
        room = _CONTACTS
        while lossy and room < min(_OF_A_BODY * n, _MANY):
            room *= 2
        near: dict[str, Any] = dict(zip(NEAR, near_sizes(moving, k - moving), strict=False))
        walls = near.pop("BOX")
        # First those that `memory.OF_SCENE` names.
        own: dict[str, Any] = {
            "STATE": ((n,), Next.TYPE), "MEMBER": ((n,), Member.TYPE), "RESTING": ((n,), Rest.TYPE),
            "PLACE": ((n,), np.int64), **near, "CORE": ((2, corners, 4), np.float64),
            "SIDE": ((side_rows(thin, k),), Side.TYPE), "PAR": ((1,), Step.TYPE), "COUNT": ((1,), Count.TYPE),
            "PULL": ((n, 3), np.float64), "BEGAN": ((n, 3), np.float64), "HEAP_TIME": ((8 * n + 64,), np.float64),
            "HEAP_BODY": ((8 * n + 64,), np.int64), "BLOCK": ((n,), np.int64), "BOX": walls,
            "CORNER": ((4 * k if thin else 0,), Corner.TYPE), "MISSED": ((_MISSED,), Missed.TYPE),
        }  # fmt: skip
        arrays = dict(zip(own, self._memory.side_by_side(*own.values()), strict=True))
        for name in ("GRID", "PAR", "COUNT"):
            arrays[name] = arrays[name][0]
        KEYS = self._again("KEYS", 4 * room, np.int64)
        KEYS.fill(-1)
        scene = Scene(
            BODY=BODY, SHAPE=SHAPE, LINK=LINK, VERTEX=VERTEX, HELD=HELD, RULE=_NO_RULE, CSR=NO_GRID, KEYS=KEYS,
            LOG=self._again("LOG", 4 * n + 64, Impulse.TYPE), FORCES=self._again("FORCES", 4 * room, Force.TYPE),
            PUSHED_BY=self._again("PUSHED_BY", room, Pair.TYPE), PUSHED=self._again("PUSHED", room, Pushed.TYPE),
            **arrays,
        )  # fmt: skip
        scene.COUNT.lossy = lossy
        table = table_of(scene, words=dict(zip(own, self._memory.words, strict=True)))
        begin_scene(table)
        laid = filled(scene, table)
        self.own = self._memory.first(len(OF_SCENE)) if laid[0] is scene else None
        return laid

    def unjointed(self, n: int) -> tuple[Joints, Table]:
        """The arrays `Joints` of a scene without joints, of n bodies or more, and their table."""
        if self._unjointed is None or len(self._unjointed[0].OF) < n:
            joints = make_joints(rows(Body, 2 * n), rows(Joint, 0), rows(Body, 0), ORDER)
            self._unjointed = joints, table_of(joints)
        return self._unjointed

    def _again(self, name: str, count: int, dtype: Any) -> Any:
        """So many rows, of any content."""
        kept = self._rows.get(name)
        if kept is None or not count <= len(kept) <= 8 * count:
            kept = self._rows[name] = np.zeros(count, dtype)
        return kept[:count]
