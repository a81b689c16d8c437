"""What steps change in the arrays of a scene besides poses and velocities, in one piece of memory.

If this memory is that of a new scene, the scene follows the path of a new one, from any poses and velocities. Memory of
a scene is made and used again in four ways:

| by | memory | made | so that |
|---|---|---|---|
| `scene_memory.SceneMemory` | of all arrays | for a stepper; readings use it in turn | few are made |
| `scene.EventLoop._grow` | of GROWN_ARRAYS, and near lists | where a step needs more | the step goes on |
| `Remembering.keep_fresh` | of OF_SCENE in one piece, and a copy | before the first step | `reset_to` copies it |
| `remembered`, `recalled` | of a state: rows that are used | by `get_state` | `set_state` returns to it |
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..arrays import AnyArray, IntArray, address_of, side_by_side
from ..compiled.records import R, Rows
from ..model.bodies import MOBILITY, OF_SHAPES
from ..model.scene import Scene

# Fields of `Scene`. The tables of forces are emptied where a run begins (`run.set_back`).
OF_SCENE = (
    "PAR", "COUNT", "GRID", "STATE", "MEMBER", "RESTING", "PLACE", "MARK", "CELL", "LIST", "POOL", "FLAG", "HEAD",
    "CORE", "SIDE",
)  # fmt: skip
# Those that are made larger on the way.
GROWN_ARRAYS = ("LOG", "PUSHED_BY", "PUSHED", "KEYS", "FORCES")


def lengthened(table: Rows[R], used: int) -> Rows[R]:
    """A table of twice as many rows, with the first `used` ones copied."""
    longer: Rows[R] = np.zeros(2 * len(table), table.dtype)  # type: ignore[assignment]
    longer[:used] = table[:used]
    return longer


def gathered(*parts: tuple[Any, tuple[str, ...]]) -> tuple[list[Any], IntArray]:
    """Copies of the named arrays of each part, a named tuple, in one piece of memory. Returns the parts with the
    copies, and that memory as integers."""
    held = [np.asarray(getattr(arrays, name)) for arrays, names in parts for name in names]
    copies = side_by_side(*((array.shape or (1,), array.dtype) for array in held))
    for copy, array in zip(copies, held, strict=True):
        copy[...] = array
    piece = _piece(copies)
    # A record is a row of an array of length 1.
    fields = iter([copy if array.shape else copy[0] for copy, array in zip(copies, held, strict=True)])
    return [arrays._replace(**{name: next(fields) for name in names}) for arrays, names in parts], piece


def _piece(arrays: list[AnyArray]) -> IntArray:
    """The memory from the first array to the end of the last one, as integers."""
    memory: AnyArray = arrays[0]
    while isinstance(memory.base, np.ndarray):
        memory = memory.base
    start = address_of(arrays[0]) - address_of(memory)
    end = address_of(arrays[-1]) - address_of(memory) + arrays[-1].nbytes
    piece: IntArray = memory[start : start + -(-(end - start) // 8) * 8].view(np.int64)
    return piece


# Of a state: the fields of `Scene` that keep their lengths.
_WHOLE = ("BODY", "PULL", "BEGAN", *(name for name in OF_SCENE if name not in ("POOL", "FLAG", "CORE")))


def remembered(scene: Scene) -> list[AnyArray]:
    """All arrays that determine the next step of a scene, apart from shapes and the states exchanged with pymunk."""
    end, pushes = int(scene.GRID.pool_end), int(scene.COUNT.pushes)
    used = np.flatnonzero(scene.KEYS >= 0)
    sizes = np.array([len(scene.POOL), end, len(scene.KEYS), len(used), len(scene.PUSHED), pushes], np.int64)
    return [
        sizes, *(np.asarray(getattr(scene, name)) for name in _WHOLE), scene.POOL[:end], scene.FLAG[:end],
        scene.PUSHED_BY[:pushes], scene.PUSHED[:pushes], used, scene.KEYS[used], scene.FORCES[used],
    ]  # fmt: skip


def recalled(scene: Scene, take: Callable[[Any, tuple[int, ...]], AnyArray]) -> Scene:
    """The scene with the arrays of `remembered`; BODY and records are overwritten in place.

    Args:
        take: returns the next array, for a dtype and a shape.
    """
    room, end, slots, used, many, pushes = take(np.int64, (6,)).tolist()
    whole = {name: np.asarray(getattr(scene, name)) for name in _WHOLE}
    new: dict[str, Any] = {name: take(array.dtype, array.shape).copy() for name, array in whole.items()}
    for name in (*MOBILITY, *OF_SHAPES):
        new["BODY"][name] = scene.BODY[name]
    for name in ("BODY", "GRID", "PAR", "COUNT"):
        whole[name][...] = new.pop(name)
    # The lengths are part of the state: they determine when tables grow, and all lists are made again when POOL grows.
    for name, kept, length in (
        ("POOL", end, room), ("FLAG", end, room), ("PUSHED_BY", pushes, many), ("PUSHED", pushes, many)
    ):  # fmt: skip
        new[name] = np.zeros(length, getattr(scene, name).dtype)
        new[name][:kept] = take(new[name].dtype, (kept,))
    at = take(np.int64, (used,))
    new["KEYS"], new["FORCES"] = np.full(slots, -1, np.int64), np.zeros(slots, scene.FORCES.dtype)
    new["KEYS"][at] = take(np.int64, (used,))
    new["FORCES"][at] = take(scene.FORCES.dtype, (used,))
    return scene._replace(**new)
