"""The state of a stepper as one array of 64-bit integers: everything that determines the path of its space.

    magic number, fingerprint, number of parts, length of each part; then the parts.

Lengths are numbers of integers; each part is the memory of an array, filled up with zeros. Integers, because floats may
be NaN: two states are equal if and only if their arrays are. `get_state` and `set_state` have the parts in the same
order.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import numpy as np

from .arrays import AnyArray, FloatArray, IntArray
from .compiled.records import RECORD_TYPES, numbers
from .impacts.scene import EventLoop
from .layout import STATE_COLUMNS, WRITTEN
from .model.joints import EDITED, OF_STEPS, RATCHET
from .saved import differences
from .space.bodies import moving
from .space.constraints import forget_notches
from .space.decisions import DECISION_COLUMNS
from .space.world import World

if TYPE_CHECKING:
    import pymunk

    from .runs import RunningStepper

_MARK = 0x65656361_00000006


def get_state(stepper: RunningStepper) -> IntArray:
    """See `RunningStepper.get_state`."""
    world, loop = stepper.current(), stepper.event_loop
    at = _rows(world)  # states have bodies in the order of `_everyone`
    parts: list[AnyArray] = [world.state[at], np.array([stepper.time]), *stepper.sleep_state(_everyone(stepper.space))]
    decided = stepper.decisions.state(world)
    parts += [np.array([len(decided)]), decided]
    if loop is not None and not world.bodies.asleep.any():
        parts += [world.STATES[WRITTEN, at], world.EXTRA[at], *loop.remembered()]
        if world.joints is not None:
            joints = world.joints
            rates = np.array([joints.rates.get(item, (np.nan, np.nan)) for item in joints.items])
            parts += [joints.joint, numbers(loop.joints.TALLY), rates]
    inner = [_words(part) for part in parts]
    head = [_MARK, _fingerprint(stepper.space, loop), len(inner), *map(len, inner)]
    return np.concatenate((np.array(head, np.int64), *inner))


def set_state(stepper: RunningStepper, state: AnyArray) -> None:
    """See `RunningStepper.set_state`."""
    if state.ndim == 1 and state.dtype == np.int64:
        _recall(stepper, state)
    else:
        _place(stepper, np.asarray(state, float))
    if stepper.sync:
        for body in moving(stepper.space):
            stepper.space.reindex_shapes_for_body(body)


def _place(stepper: RunningStepper, state: FloatArray) -> None:
    """Set poses and velocities of the bodies to `state` (b, 6), and forget everything else."""
    bodies = moving(stepper.space)
    if state.shape != (len(bodies), 6):
        raise ValueError(
            f"a state of shape {state.shape}: give what get_state returned, or ({len(bodies)}, 6), position, angle, "
            "velocity and spin of each body that is not static"
        )
    if not np.isfinite(state).all():
        i, k = np.argwhere(~np.isfinite(state))[0].tolist()
        raise ValueError(f"state[{i}, {k}] is {state[i, k]}: give finite numbers")
    stepper.wake()
    world = stepper.current()
    rows = [world.bodies.row[body] for body in bodies]
    whole = np.zeros((len(world.bodies), STATE_COLUMNS))
    whole[:] = world.state
    whole[rows, :6], whole[rows, 6:] = state, 0.0
    world.bodies.scatter(whole, unchanged=True)
    forget_notches(stepper.space)
    stepper.reset_to(world, whole)


def _recall(stepper: RunningStepper, state: IntArray) -> None:
    """Return to a result of `get_state`."""
    space, parts = stepper.space, _Parts(state)
    stepper.current()  # a copy of a stepper has no event loop before
    if parts.fingerprint != _fingerprint(space, stepper.event_loop):
        raise ValueError(
            "this state is of another space, or of another stepper: give one of a space with the same bodies, shapes "
            "and joints, added in the same order"
        )
    everyone = _everyone(space)
    N = len(everyone)
    states = parts.take(np.float64, (N, STATE_COLUMNS))
    if not np.isfinite(states).all():
        raise ValueError("this state is not finite: it was taken of bodies with a pose or velocity that is not")
    stepper.wake()
    world = stepper.current()
    at, whole = _rows(world), world.state.copy()
    moves = ~world.bodies.static
    whole[at] = states
    whole[~moves] = world.state[~moves]
    world.bodies.scatter(whole, unchanged=True)
    stepper.time = float(parts.take(np.float64, (1,))[0])
    rested, groups, timers = parts.take(np.float64, (N,)), parts.take(np.int64, (N,)), parts.take(np.int64, (2,))
    decided = parts.take(np.float64, (int(parts.take(np.int64, (1,))[0]), DECISION_COLUMNS))
    if parts.left:
        _remember(stepper, world, parts, at)
    else:
        stepper.refresh()
    stepper.decisions.recall(space, decided)
    stepper.recall_sleep(everyone, rested, groups, timers)


def _remember(stepper: RunningStepper, world: World, parts: _Parts, at: IntArray) -> None:
    """Restore the results of earlier steps from the remaining parts of a state. `at` (N,): the present rows of its
    bodies."""
    loop, joints = stepper.event_loop, world.joints
    assert loop is not None
    moves = ~world.bodies.static
    left = np.empty_like(world.STATES[WRITTEN])
    left[at] = parts.take(np.float64, left.shape)
    world.EXTRA[at] = parts.take(np.float64, world.EXTRA.shape)
    same_lists = loop.recall(parts.take)
    if joints is not None:
        joint = parts.take(joints.joint.dtype, joints.joint.shape)
        for name in OF_STEPS:
            joints.joint[name] = joint[name]
        ratchets = joints.joint["kind"] == RATCHET
        joints.joint["notch"][ratchets] = joint["notch"][ratchets]
        for name in ("stiffness", "rest", "push"):
            joints.joint[name][joints.functions] = joint[name][joints.functions]
        # Islands at rest are solved again if the program has edited their joints since.
        for name, unequal in differences(joints.joint, joint):
            if name != "body":  # bodies may have other rows now
                joints.joint["touched"][unequal] = EDITED
        loop.joints.AT_START[:] = joints.joint
        tally = numbers(loop.joints.TALLY)
        tally[:] = parts.take(np.int64, tally.shape)
        rates = parts.take(np.float64, (len(joint), 2))
        known = zip(joints.items, rates.tolist(), strict=True)
        joints.rates = {item: (r, h) for item, (r, h) in known if r == r}  # NaN stands for no rate
        joints.write()
    world.STATES[WRITTEN, moves] = left[moves]
    if world.eccentric:
        # pymunk has rounded the positions of such bodies when they were written: they count as unedited.
        world.gather()
        world.accept_rounding()
    if not same_lists:
        stepper.refresh()


class _Parts:
    """The parts of a state, read one after the other; ValueError if the array is no state, or a part does not fit."""

    def __init__(self, state: IntArray) -> None:
        count = int(state[2]) if len(state) > 3 and state[0] == _MARK else -1
        lengths = state[3 : 3 + max(count, 0)]
        if count < 0 or len(lengths) != count or lengths.min(initial=0) < 0 or len(state) != 3 + count + lengths.sum():
            raise ValueError("this is not a state that get_state returned, or of another version of the package")
        self.fingerprint = int(state[1])
        self._state, self._ends = state, (3 + count + np.cumsum([0, *lengths])).tolist()
        self._next = 0

    @property
    def left(self) -> bool:
        """Whether there are more parts."""
        return self._next < len(self._ends) - 1

    def take(self, dtype: Any, shape: tuple[int, ...]) -> AnyArray:
        """The next part, as a copy of this dtype and shape."""
        kind = np.dtype(dtype)
        size = int(np.prod(shape)) * kind.itemsize
        begin, end = self._ends[self._next : self._next + 2]
        if -(-size // 8) != end - begin:
            raise ValueError("this state is of another space, or of another version of the package")
        self._next += 1
        part: AnyArray = np.frombuffer(self._state[begin:end].tobytes()[:size], kind).reshape(shape)
        return part


def _words(array: AnyArray) -> IntArray:
    """The memory of an array as integers, with zeros up to a multiple of 8 bytes."""
    content = np.ascontiguousarray(array).tobytes()
    return np.frombuffer(content + bytes(-len(content) % 8), np.int64)


def _everyone(space: pymunk.Space) -> list[pymunk.Body]:
    """All bodies in the order in which they were added; pymunk's own order differs once some have slept."""
    return [*space.bodies, space.static_body]


def _rows(world: World) -> IntArray:
    """(N,) the rows in the world of the bodies of `_everyone`."""
    return np.array([world.bodies.row[body] for body in _everyone(world.space)], np.int64)


def _fingerprint(space: pymunk.Space, loop: EventLoop | None) -> int:
    """Hash of what a state does not contain, but must fit: kinds of bodies, shapes and joints and how they are
    connected, the kind of the event loop, sizes of records."""
    bodies = {body: i for i, body in enumerate(_everyone(space))}
    hashed: list[object] = [type(loop).__name__, None if loop is None else loop.together]
    hashed += [(name, kind.itemsize) for name, kind in sorted(RECORD_TYPES.items())]
    hashed += [body.body_type for body in bodies]
    for s in space.shapes:
        if s.body is not None:
            corners = len(s.get_vertices()) if hasattr(s, "get_vertices") else 0
            hashed.append((type(s).__name__, bodies.get(s.body, -1), s.sensor, corners))
    hashed += [(type(c).__name__, bodies.get(c.a, -1), bodies.get(c.b, -1)) for c in space.constraints]
    return int.from_bytes(hashlib.sha256(repr(hashed).encode()).digest()[:8], "little", signed=True)
