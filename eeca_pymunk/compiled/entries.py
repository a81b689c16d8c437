"""The entry points: every kernel that Python calls, with the types of its arguments and the fields of its tables.

`ENTRIES` maps "room.module:function" to the types of its arguments. `f8[2]` is a C-contiguous array of 64-bit floats
with two dimensions, `i8`, `i4` and `u1` are integers; `f8`, `i8` and `bool` without brackets are numbers; a name in
braces is a table of `TABLES`. An entry returns an integer, or nothing. In an entry that Python binds to its arrays
(`kernels.Kernel.bind`) arrays come before numbers.

`TABLES` lists the arrays of each table in the order of its named tuple, for processes that do not import the records'
annotations; `tables.table_of` compares. `SOURCES` lists the files and rooms that contain kernels; a library carries
their hash.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from .records import RECORD_TYPES

SOURCES = (
    "arrays.py", "layout.py", "transfer.py", "rehearsing.py", "sleepers.py", "world_rows.py", "compiled", "model",
    "build", "energy", "geometry", "rows", "pairs", "prediction", "newton", "contacts", "joints", "islands", "jointed",
    "impacts",
)  # fmt: skip

TABLES = {
    "Scene": """
        BODY:Body[1] STATE:Next[1] SHAPE:Shape[1] LINK:Link[1] VERTEX:f8[2] MARK:Mark[1] CELL:Cell[1] LIST:List[1]
        POOL:i4[1] FLAG:u1[1] HEAD:i8[1] GRID:Grid BOX:f8[2] CSR:i8[1] RULE:f8[2] HEAP_TIME:f8[1]
        HEAP_BODY:i8[1] LOG:Impulse[1] BEGAN:f8[2] PLACE:i8[1] BLOCK:i8[1] PULL:f8[2] MEMBER:Member[1] RESTING:Rest[1]
        PUSHED_BY:Pair[1] PUSHED:Pushed[1] KEYS:i8[1] FORCES:Force[1] CORE:f8[3]
        SIDE:Side[1] CORNER:Corner[1] MISSED:Missed[1] PAR:Step COUNT:Count
    """,
    "Reading": """
        TOTALS:i8[1] BODIES:BodyValues[1] SHAPES:ShapeValues[1] OWNER:i8[1] POINT:f8[2] POINT_PLACED:f8[2] STATES:f8[3]
        IDS:i8[2] EXTRA:f8[2] ENDS:f8[1] HOOKED:f8[3] BODY:Body[1] SHAPE:Shape[1] LINK:Link[1] VERTEX:f8[2] ORDER:i8[1]
        MEASURED:Measures
    """,
    "Joints": """
        JOINT:Joint[1] PARTNER:Body[1] STILL:i8[1] PINNED:Pinned[1] ROOM:i8[1] COMPONENT:Component[1]
        JOINED:ComponentBody[1] COUPLING:Coupling[1] HINGE:JointStep[1] LOCAL:BodyStep[1] MATRIX:f8[1] RIGHT:f8[1]
        MORE:f8[1] STIFF:f8[2] PROGRESS:Progress NEWTON:Newton PARTS:Parts AGREEMENT:Agreement RUNG_LEDGER:JointLedger
        PIVOTS:i8[1] OF:i8[1] AT_START:Joint[1] STEPPED:JointLedger[1] TALLY:Tally
    """,
    "Island": """
        WHO:i8[1] POSE:f8[2] V:f8[2] ACC:f8[2] IM:f8[1] II:f8[1] EXTENT:f8[1] LEVER:f8[1] PAIRS:i8[2]
    """,
    "IslandContacts": """
        ROWS:Row[1] L:f8[2] VN:f8[2] JUMP:f8[2] OUT:Solved[1]
    """,
    "RunArrays": """
        RUN:Run KEPT:i8[1] FRAMES:f8[2] SUMS:f8[2] EVENTS:Impulse[1] TOTAL:f8[1] INITIAL:f8[2] PUSH:f8[2]
        COUNTS:i8[2] OWN:i8[1] FRESH:i8[1]
    """,
}

ENTRIES = {
    "compiled.layouts:lay_out": "i8[2] i8[1] i8[1] i8",
    "geometry.gap:gaps": "{Scene} i8[2] f8[2] f8[2] f8[2]",
    "pairs.grid:build": "{Scene} f8",
    "pairs.margins:begin_lists": "{Scene}",
    "pairs.margins:fill_lists": "{Scene} f8[1]",
    "pairs.candidates:candidates": "{Scene} f8[1] i8[2] f8[2]",
    "transfer:read_states": "f8[3] i8[2] f8[2] Body[1] f8 f8 f8",
    "transfer:write_states": "f8[3] i8[2] f8[2] Body[1] f8[1] f8 i8",
    "transfer:accept_static": "{Reading}",
    "transfer:write_ends": "{Reading} i8",
    "rehearsing:place_for_rehearsal": "{Reading} HandledShape[1] i8[2] f8 f8 f8 f8",
    "rehearsing:copy_start": "{Reading}",
    "rehearsing:accept_rounding": "{Reading}",
    "rehearsing:alter_end": "{Reading} i8",
    "sleepers:rests": "f8[3] i8[2] i8[1] f8[1] f8[1] i8[1] f8 f8 f8",
    "sleepers:approaches": "f8[3] i8[1] i8[1] f8[1] f8[1] f8[2] i8[1] f8 f8",
    "sleepers:connect": "i8[2] i8[1] i8[1] i8[1]",
    "sleepers:touches_sleeper": "Impulse[1] i8[1] i8[1] i8[1] i8",
    "world_rows:write_rows": "{Reading}",
    "world_rows:read_space": "{Reading} i8",
    "rehearsing:record_changes": "{Reading} i8",
    "impacts.scene_memory:measure_scene": "{Reading}",
    "impacts.scene_memory:begin_scene": "{Scene} i8 i8 i8 i8 i8",
    "impacts.taking_over:take_over": "{Scene} {Scene} i8[1]",
    "impacts.edits:renew": "{Scene} i8[1]",
    "impacts.edits:edit_surface": "{Scene} i8 f8 f8 f8 f8",
    "impacts.edits:edit_filter": "{Scene} i8 i8 i8 i8",
    "impacts.edits:edit_mass": "{Scene} i8 f8 f8",
    "islands.accounting:flag_pairs": "{Scene}",
    "impacts.step:step": "{Scene} {Joints} {Reading} f8 f8 f8 f8",
    "impacts.step:resume_step": "{Scene} {Joints} {Reading}",
    "impacts.run:run": "{Scene} {Joints} {RunArrays} {Reading}",
    "joints.workspace:plan_components": "{Scene} {Joints}",
    "joints.workspace:tie_components": "{Scene} {Joints}",
    "joints.pinned:find_pinned": "{Scene} {Joints}",
    "joints.pinned:release_held": "{Scene} {Joints}",
    "joints.partners:read_partners": "f8[1] i8[1] f8[2] f8[2] Body[1] Joint[1] i8",
    # Only tests call this, which solves single islands: some hundred times slower as plain Python.
    "contacts.interval:step_island": "{Scene} {Island} {IslandContacts} i8 f8 i8 f8 f8 f8",
    "contacts.forces:copy_recent": "i8[1] Force[1] Count i8[1] Force[1] f8",
}

_CODES = {"f8": "<f8", "i8": "<i8", "i4": "<i4", "u1": "|u1"}


@functools.cache
def dtype_of(kind: str) -> tuple[Any, int]:
    """The numpy dtype and the dimensions of `f8[2]`; those of `Body[1]`, an array of records, and of `Step`, one."""
    code, _, rest = kind.partition("[")
    return RECORD_TYPES[code] if code in RECORD_TYPES else np.dtype(_CODES[code]), int(rest.rstrip("]") or 0)


def is_array(kind: str) -> bool:
    """Whether this is the type of an array, a record or a table."""
    return kind.endswith(("]", "}")) or kind in RECORD_TYPES


@functools.cache
def table_fields(name: str) -> tuple[tuple[str, Any, int], ...]:
    """(name, dtype, dimensions) of the arrays of a table."""
    pairs = (field.split(":") for field in TABLES[name].split())
    return tuple((field, *dtype_of(kind)) for field, kind in pairs)
