"""The entry points: every kernel that Python calls, with the types of its arguments and the fields of its tables.

`ENTRIES` maps "room.module:function" to the types of its arguments. `f8[2]` is a C-contiguous array of 64-bit floats
with two dimensions, `i8`, `i4` and `u1` are integers; `f8`, `i8` and `bool` without brackets are numbers; a name in
braces is a table of `TABLES`. An entry returns an integer, or nothing. One that Python binds to its arrays has them
before its numbers.

`TABLES` lists the arrays of each table in the order of its named tuple. `SOURCES` lists the files and rooms of which
machine code is made: a library carries their hash.
"""

from __future__ import annotations

import functools

SOURCES = (
    "arrays.py", "layout.py", "transfer.py", "compiled", "build", "energy", "geometry", "rows", "pairs", "sustained",
    "joints", "impacts", "jointed",
)  # fmt: skip

TABLES = {
    "Scene": """
        BODY:f8[2] STATE:i8[2] SHAPE:f8[2] LINK:i8[2] VERTEX:f8[2] MARK:f8[2] CELL:i8[2] LIST:i8[2] POOL:i4[1]
        FLAG:u1[1] HEAD:i8[1] GRID:f8[1] INFO:i8[1] BOX:f8[2] CSR:i8[1] RULE:f8[2] HEAP_TIME:f8[1] HEAP_BODY:i8[1]
        LOG:f8[2] BEGAN:f8[2] PLACE:i8[1] BLOCK:i8[1] PULL:f8[2] MEMBER:i8[2] RESTING:f8[2] PUSHED_BY:i8[2]
        PUSHED:f8[2] KEYS:i8[1] FORCES:f8[2] WORK:f8[3] PAR:f8[1] COUNT:i8[1]
    """,
    "Joints": """
        JOINT:f8[2] TIE:i8[2] PARTNER:f8[2] SPAN:i8[2] MEMBER:i8[2] LINK:i8[2] HINGE:f8[2] LOCAL:f8[2] NODE:i8[2]
        MATRIX:f8[1] RIGHT:f8[1] MORE:f8[1] STIFF:f8[2] FOUND:f8[1] PART:f8[1] PIVOTS:i8[1] OF:i8[1] KEPT:f8[2]
        SIDES:i8[2] STEPPED:f8[2] TALLY:i8[1]
    """,
}

ENTRIES = {
    "geometry.gap:gaps": "i8[2] f8[2] f8[2] f8[2] i8[2] f8[2] f8[3] f8[2]",
    "pairs.walls:wall_grid": "f8[2] f8[1] i8[1] i8[1]",
    "pairs.grid:build": "f8[2] f8[2] i8[2] f8[2] i8[2] i8[2] i4[1] u1[1] i8[1] f8[1] i8[1] f8[2] i8[1] f8",
    "pairs.candidates:candidates": "f8[2] f8[2] i8[2] f8[2] f8[3] f8[2] i8[2] i8[2] i4[1] u1[1] i8[1] f8[1] i8[1] f8[2]"
    " i8[1] f8[1] i8 f8[1] i8[2] f8[2]",
    "transfer:take": "f8[3] i8[2] f8[2] f8[2] f8 f8 f8",
    "transfer:give": "f8[3] i8[2] f8[2] f8[2] f8[1] f8 f8 i8",
    "transfer:lay": "f8[3] i8[2] f8[1] i8",
    "transfer:lay_rest": "f8[3] f8[1] i8",
    "transfer:fly": "f8[3] i8[2] f8[2] f8[2] f8[1] f8 f8 f8 f8",
    "impacts.booking:flag_again": "{Scene}",
    "impacts.step:step": "{Scene} f8[3] i8[2] f8[2] f8[1] f8 f8 f8 f8 i8 bool i8",
    "impacts.together:step_together": "{Scene} f8[3] i8[2] f8[2] f8[1] f8[1] f8 f8 f8 f8 i8",
    "joints.plan:make_plan": "f8[2] f8[2] i8[2] i8[2] i8[2] i8[2]",
    "joints.world:step_all": "f8[2] f8[2] i8[2] i8[2] i8[2] i8[2] i8 f8 i8 f8[2] f8[2] i8[2] f8[1] f8[1] f8[1] i8[1]"
    " f8[2] f8[1] f8[1] f8[2] i8[1]",
    "jointed.loop:step_jointed": "{Scene} {Joints} f8[3] i8[2] f8[2] f8[1] f8 f8 f8 f8 i8 bool i8",
    "jointed.together:step_together_jointed": "{Scene} {Joints} f8[3] i8[2] f8[2] f8[1] f8[1] f8 f8 f8 f8 i8",
    # Of tests alone, which step islands by themselves: some hundred times slower as plain Python.
    "sustained.step:step_island": "f8[2] f8[2] f8[2] f8[1] f8[1] f8[1] f8[1] i8 i8[2] i8 f8[2] f8[2] i8[2] f8[2] f8[3]"
    " f8 i8 f8 f8 i8[1] f8[2] i8[1] f8 f8[1] f8 i8[1] i8[1] f8[2] i8[1] f8[2] f8[2] f8[2] f8[2] f8[1] f8[1]",
    "sustained.memory:forget": "i8[1] f8[2] i8[1] i8[1] f8[2] f8",
}

_CODES = {"f8": "<f8", "i8": "<i8", "i4": "<i4", "u1": "|u1"}


def split(kind: str) -> tuple[str, int]:
    """The numpy dtype and the dimensions of `f8[2]`."""
    code, _, rest = kind.partition("[")
    return _CODES[code], int(rest.rstrip("]"))


def is_array(kind: str) -> bool:
    """Whether this is the type of an array or of a table."""
    return kind.endswith(("]", "}"))


@functools.cache
def table_fields(name: str) -> tuple[tuple[str, str, int], ...]:
    """(name, dtype, dimensions) of the arrays of a table."""
    pairs = (field.split(":") for field in TABLES[name].split())
    return tuple((field, *split(kind)) for field, kind in pairs)
