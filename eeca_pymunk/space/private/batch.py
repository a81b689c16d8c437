"""Private names behind pymunk's batch calls, which read and write the states of all bodies in given memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pymunk
from pymunk import batch
from pymunk._chipmunk_cffi import ffi, lib

from ...arrays import AnyArray, FloatArray, IntArray

OF_LIBRARY = (
    "cpSpaceEachBody", "pmSpaceBodyGetIteratorFuncBatched", "pmSpaceBodySetIteratorFuncBatched",
    "cpSpaceEachCachedArbiter", "pmSpaceArbiterIteratorFuncBatched", "pmIntArrayNew", "pmIntArrayFree",
)  # fmt: skip
TYPES = ("pmBatchedData *", "pmFloatArray *", "pmIntArray *")
_MOTION = batch.BodyFields.VELOCITY | batch.BodyFields.ANGULAR_VELOCITY
_MOTION |= batch.BodyFields.FORCE | batch.BodyFields.TORQUE
_BOTH_IDS = batch.ArbiterFields.BODY_A_ID | batch.ArbiterFields.BODY_B_ID
_COUNT = batch.ArbiterFields.CONTACT_COUNT
# The readers and writers of whole spaces have attributes: `values` and `numbers`, the C arrays to which a later call
# may give other memory (`last`), and `held`, the present memory, which is not freed before.


def reader(
    space: pymunk.Space, fields: batch.BodyFields, floats: FloatArray, ids: IntArray, last: Any = None
) -> Callable[[], None]:
    """`batch.get_space_bodies` into given memory, at a quarter of its cost.

    The caller must ensure that `floats` and `ids`, C-contiguous, have room for one body more than the space has at
    every call: pymunk would replace memory that is too small by its own, and free it.

    Args:
        last: a reader of the same fields of the same space. It is changed to use these arrays, and returned; making a
            new one takes three times as long.
    """
    if last is not None:
        _point(last.values, "cpFloat[]", floats)
        _point(last.numbers, "uintptr_t[]", ids)
        last.held = floats, ids
        return last  # type: ignore[no-any-return]
    values, numbers = _array("pmFloatArray *", "cpFloat[]", floats), _array("pmIntArray *", "uintptr_t[]", ids)
    data = batched(fields, values, numbers)
    c, each, filled, listed = space._space, lib.cpSpaceEachBody, _num(values), _num(numbers)
    function = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")

    def read() -> None:
        filled[0] = 0
        listed[0] = 0
        each(c, function, data)

    made: Any = read
    made.values, made.numbers, made.held = values, numbers, (floats, ids)
    return read


def reader_of(bodies: Sequence[pymunk.Body], fields: batch.BodyFields, floats: FloatArray) -> Callable[[], None]:
    """As `reader`, without ids, for some bodies, one call for each; they need not be in a space."""
    values, numbers = _array("pmFloatArray *", "cpFloat[]", floats), ffi.new("pmIntArray *")
    data = batched(fields, values, numbers)
    return _one_by_one(lib.pmSpaceBodyGetIteratorFuncBatched, bodies, data, values, (floats, numbers))


def ordered(space: pymunk.Space, ids: AnyArray) -> Callable[[], bool]:
    """A function that returns whether the bodies of the space have these ids, in this order. Bodies that fall asleep
    or wake get other places in it: one call finds this for all of them."""
    bodies, count, kept = space._bodies, len(space._bodies), np.zeros(len(ids) + 1, np.int64)
    read, found, known = reader(space, batch.BodyFields.BODY_ID, np.zeros(1), kept), kept[:-1], ids.tobytes()

    def unchanged() -> bool:
        if len(bodies) != count:  # more have no room
            return False
        read()
        return found.tobytes() == known

    return unchanged


def writer(
    space: pymunk.Space, fields: batch.BodyFields, floats: FloatArray, bodies: Sequence[pymunk.Body] | None = None,
    last: Any = None,
) -> Callable[[], None]:  # fmt: skip
    """`batch.set_space_bodies` from given memory, C-contiguous, with a row for every body of the space.

    With `bodies`, the first ones of the space in pymunk's order, only these are written, one after the other.
    `last`: as for `reader`; a writer of some bodies is not used again.
    """
    if bodies is None and hasattr(last, "values"):
        _point(last.values, "cpFloat[]", floats)
        last.held = floats
        return last  # type: ignore[no-any-return]
    values, numbers = _array("pmFloatArray *", "cpFloat[]", floats), ffi.new("pmIntArray *")
    data = batched(fields, values, numbers)
    c, each, taken = space._space, lib.cpSpaceEachBody, _num(values)
    function = ffi.addressof(lib, "pmSpaceBodySetIteratorFuncBatched")

    def write() -> None:
        taken[0] = 0
        each(c, function, data)

    if bodies is None:
        made: Any = write
        made.values, made.numbers, made.held = values, numbers, floats
        return write
    return _one_by_one(lib.pmSpaceBodySetIteratorFuncBatched, bodies, data, values, (floats, numbers))


def stopper(space: pymunk.Space, count: int) -> tuple[Callable[[], None], Callable[[], None]]:
    """As `rest.stopper`, for a space of so many bodies, the static one included, of which none sleeps and none comes or
    goes meanwhile: three calls, however many they are."""
    kept, zeros = np.zeros(6 * (count + 1)), np.zeros(6 * (count + 1))
    read = reader(space, _MOTION, kept, np.zeros(1, np.int64))
    stop, go_on = writer(space, _MOTION, zeros), writer(space, _MOTION, kept)

    def read_and_stop() -> None:
        read()
        stop()

    return read_and_stop, go_on


def _of_arbiters(space: pymunk.Space, fields: batch.ArbiterFields, columns: int) -> IntArray:
    """(n, columns) these integers of each arbiter that pymunk keeps."""
    floats, numbers = ffi.new("pmFloatArray *"), lib.pmIntArrayNew(0)
    try:
        data = batched(fields, floats, numbers)
        lib.cpSpaceEachCachedArbiter(space._space, ffi.addressof(lib, "pmSpaceArbiterIteratorFuncBatched"), data)
        return np.frombuffer(ffi.buffer(numbers.arr, 8 * numbers.num), np.int64).reshape(-1, columns).copy()
    finally:
        lib.pmIntArrayFree(numbers)


def arbiter_bodies(space: pymunk.Space) -> list[int]:
    """For each arbiter that pymunk keeps, the exclusive or of the ids of both bodies."""
    ids = _of_arbiters(space, _BOTH_IDS, 2)
    found: list[int] = (ids[:, 0] ^ ids[:, 1]).tolist()
    return found


def touching(space: pymunk.Space) -> IntArray:
    """(n, 2) ids of the pairs of bodies that touched in pymunk's last step, or have woken since: arbiters that pymunk
    only remembers have no contact."""
    found = _of_arbiters(space, _BOTH_IDS | _COUNT, 3)
    return found[found[:, 2] > 0, :2]


def _one_by_one(
    one: Any, bodies: Sequence[pymunk.Body], data: Any, values: Any, arrays: tuple[object, ...]
) -> Callable[[], None]:
    """A function that calls `one`, of pymunk's library, for each of the bodies, and reads or writes `values` from their
    start. It refers to `arrays`, whose memory `data` points to."""
    pointers = [body._body for body in bodies]

    def call(held: object = arrays) -> None:
        values.num = 0
        for pointer in pointers:
            one(pointer, data)

    return call


def _array(kind: str, items: str, memory: FloatArray | IntArray) -> Any:
    """pymunk's array over given memory. `batch.Buffer` has arrays of its own, but never frees their memory."""
    array = ffi.new(kind)
    _point(array, items, memory)
    return array


def _num(array: Any) -> memoryview:
    """`num` of one of pymunk's arrays, which is to live longer; attributes of C structs take twice as long."""
    return memoryview(ffi.buffer(ffi.addressof(array, "num"))).cast("i")


def _point(array: Any, items: str, memory: FloatArray | IntArray) -> None:
    """Let one of pymunk's arrays, now empty, use this memory."""
    array.arr = ffi.from_buffer(items, memory)
    array.num, array.max = 0, memory.size


def batched(fields: batch.BodyFields | batch.ArbiterFields, floats: Any, ints: Any) -> Any:
    """The argument of pymunk's batch functions."""
    data = ffi.new("pmBatchedData *")
    data.fields, data.floatArray, data.intArray = fields.value, floats, ints
    return data
