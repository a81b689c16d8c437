"""Results of earlier steps that outlast the arrays of one world.

`Saved` is what a pickled stepper has of them, so that the copy continues bit by bit. `Sides` has the sides of thin
shapes, which are kept when the space is read again.
"""

from __future__ import annotations

import pickle
from collections.abc import Iterator, Sequence
from io import BytesIO

import numpy as np

from .arrays import AnyArray, BoolArray, FloatArray
from .compiled.records import Rows, columns, rows
from .compiled.sources import sources_hash
from .geometry.sides import keep_sides
from .impacts.scene import EventLoop
from .layout import BODY_ROW, PLACED, SHIFTED, WRITTEN
from .model.bodies import MOBILITY, OF_SHAPES
from .model.joints import OF_STEPS, RATCHET, Joint
from .model.parameters.intervals import INTERVAL_DEPTH_LEAST
from .model.shapes import Link, Side
from .space.decisions import Decisions
from .space.packing import ShapeRecord
from .space.world import World

_NO_SIDES = rows(Side, 0)
_TIE = "kind", "body", "bounded"  # fields of JOINT that decide the plan of the components


def differences(now: AnyArray, then: AnyArray) -> Iterator[tuple[str, BoolArray]]:
    """The fields of joints that no step changes, each with (j,) whether its values differ in two arrays of JOINT."""
    for name in Joint.TYPE.names or ():
        if name not in OF_STEPS:
            yield name, (now[name] != then[name]).reshape(len(now), -1).any(axis=1)


class Saved:
    """The event loop of a world and everything else that determines its next step; pickled with the space.

    It is used only if all shapes, bodies and joints of the unpickled space are equal to those it has recorded, and only
    by the version of the package that made it, since classes and arrays of other versions may differ. A pickle
    therefore has the version, the objects that are shared with the space, and all else as bytes, which are read only
    after versions were compared.
    """

    def __init__(self, world: World, method: EventLoop, decisions: Decisions) -> None:
        self._decided = decisions.state(world)
        self.method, self.items, self.shapes, self.parted = method, world.bodies.items, world.shapes, world.parted
        self._left, self._extra, self._rows = world.STATES[WRITTEN], world.EXTRA, world.IDS[BODY_ROW]
        joints = world.joints
        self._joints = [] if joints is None else joints.items
        self._rates = {} if joints is None else joints.rates
        # After edits of joints that no step has used yet, the copy reads all joints again.
        self._fresh = joints is None or not (joints.replan or joints.edited)
        self._pickled: tuple[str, Sequence[object], bytes] | None = None  # in a copy, until `resume`

    def __getstate__(self) -> tuple[str, Sequence[object], bytes]:
        if self._pickled is not None:
            return self._pickled
        shared = [*self.items, *self.shapes, *self._joints]
        places = {id(item): k for k, item in enumerate(shared)}
        packed = BytesIO()
        pickler = pickle.Pickler(packed, pickle.HIGHEST_PROTOCOL)
        pickler.persistent_id = lambda item: places.get(id(item))  # type: ignore[method-assign]
        pickler.dump(self.__dict__)
        return sources_hash(), shared, packed.getvalue()

    def __setstate__(self, state: tuple[str, Sequence[object], bytes]) -> None:
        self._pickled = state

    def resume(self, world: World, decisions: Decisions) -> bool:
        """Write the saved results into a world that was just read, and into the stepper's `decisions`. If the world is
        not equal to the saved one, change nothing and return False."""
        if self._pickled is not None:
            made_by, shared, packed = self._pickled
            if made_by != sources_hash():
                return False
            unpickler = pickle.Unpickler(BytesIO(packed))
            unpickler.persistent_load = shared.__getitem__  # type: ignore[method-assign]
            self.__dict__.update(unpickler.load())
        scene = self.method.scene
        row = world.bodies.row
        if not self._fresh or row.keys() != set(self.items) or world.shapes != self.shapes:
            return False
        at = np.array([row[body] for body in self.items], np.int64)  # pymunk may have another order of bodies
        same = (
            (world.IDS[BODY_ROW, at], self._rows),
            (columns(world.BODY, *OF_SHAPES), columns(scene.BODY, *OF_SHAPES)),
            (columns(world.BODY, *MOBILITY), self.method.mobility),
            (world.SHAPE, scene.SHAPE),
            (world.LINK, scene.LINK),
            (_in_order(world.VERTEX, world.LINK), _in_order(scene.VERTEX, scene.LINK)),
        )
        if scene.COUNT.disks != world.disks or not all(np.array_equal(now, before) for now, before in same):
            return False
        if not self._same_joints(world):
            return False
        joints = world.joints
        if joints is not None:
            for j in joints.measured():
                joints.set_length(j, float(self.method.joint[j].length))
            joints.joint[:] = self.method.joint
            joints.rates.update(self._rates)
            self.method.rebind(joints.joint, joints.partners.PARTNER)
            joints.planned(self.method.held)
            world.parted = self.parted
            world.find_parted()
        world.BODY[:], world.VERTEX[:] = scene.BODY, scene.VERTEX
        self.method.scene = scene._replace(BODY=world.BODY)
        moves = ~world.bodies.static[at]
        world.STATES[WRITTEN, at[moves]], world.EXTRA[at] = self._left[moves], self._extra
        decisions.recall(world.space, self._decided)
        return True

    def _same_joints(self, world: World) -> bool:
        """Whether the constraints of a world are equal to the saved ones, but for values that steps change."""
        joints, method = world.joints, self.method
        if joints is None or not method.jointed:
            return joints is None and not method.jointed
        if joints.items != self._joints or not np.array_equal(method.partner, joints.partners.PARTNER):
            return False
        differs = np.zeros(len(joints.joint), bool)
        for name, unequal in differences(method.joint, joints.joint):
            # Steps change the notch of a ratchet and the law of a spring with a function; pickles lack lengths of pins.
            if name == "notch":
                unequal[joints.joint["kind"] == RATCHET] = False
            elif name == "length":
                unequal[joints.measured()] = False
            if name not in _TIE:
                unequal[joints.functions] = False
            differs |= unequal
        return not differs.any()


class Sides:
    """The remembered sides of thin shapes of a world, to be kept when the space is patched or read again.

    Kept are those of shapes that have not changed and are near where the last step left them (see
    `transfer.read_states`), in whatever rows. Kinematic bodies with such shapes only, thin or not, count as unmoved, so
    that overlaps with them are not corrected as if they were just placed there.
    """

    def __init__(self, world: World, known: Rows[Side] | None, matter: Sequence[int]) -> None:
        """`known`: the sides; None if only kinematic bodies matter.  `matter`: the rows of shapes that do."""
        self._sided, self._known = known is not None, _NO_SIDES if known is None else known.copy()
        shapes, owner = world.shapes, world.owner.tolist()
        # Row, shape, place of the body and record of each.
        self._shapes = [(k, shapes[k], owner[k], world.records[shapes[k]]) for k in matter]
        self._count, self._bodies = len(world.shapes), world.bodies.items
        self._left: list[list[float]] = world.STATES[WRITTEN, :, :3].tolist()

    def _moves(self, world: World) -> dict[int, tuple[int, float]]:
        """For each body (old row) that is near where the last step left it: its present row, and a bound of how far its
        points were moved since (length)."""
        moves, row, rows = {}, world.bodies.row, world.IDS[BODY_ROW].tolist()
        state, extent = world.state[:, :3].tolist(), world.BODY["extent"].tolist()
        for i in {i for _, _, i, _ in self._shapes}:
            at = row.get(self._bodies[i], -1)
            if at >= 0:
                (x, y, angle), (x0, y0, angle0) = state[at], self._left[i]
                size = extent[rows[at]] if rows[at] >= 0 else 0.0
                move = abs(x - x0) + abs(y - y0) + size * abs(angle - angle0)
                if move <= INTERVAL_DEPTH_LEAST * size:
                    moves[i] = at, move
        return moves

    def recall(self, world: World, loop: EventLoop) -> None:
        """Write the sides into the loop of the present world, which has taken no step."""
        records, owner, moves = world.records, world.owner.tolist(), self._moves(world)
        matter = _that_matter(world, self._sided)
        places = {world.shapes[k]: k for k in matter}
        new_rows = [-1] * self._count  # of each old row of SHAPE; -1 if its sides are not kept
        for k, shape, i, before in self._shapes:
            place = places.get(shape, -1)
            if place < 0 or i not in moves or owner[place] != moves[i][0]:
                continue
            now = records[shape]
            if now is before or _outline(now) == _outline(before):
                new_rows[k] = place
        same, rows = set(new_rows), world.IDS[BODY_ROW].tolist()
        kept = {owner[place] for place in same if place >= 0}
        changed = {owner[place] for place in matter if place not in same} if kept else kept
        at = [i for i in kept if rows[i] >= 0 and (i not in changed if rows[i] >= world.dynamic else self._sided)]
        if at:
            nudged = {i for i, move in moves.values() if move > 0.0}
            left, present, due = world.STATES[WRITTEN], world.state, world.BODY["due"]
            for i in at:  # one by one: for few bodies numpy's indices take several times as long
                left[i, :3] = present[i, :3]
                due[rows[i]] = SHIFTED if i in nudged else PLACED
        if self._sided and loop.thin:
            keep_sides(loop.table, self._known, np.array(new_rows, np.int64))


def _that_matter(world: World, sided: bool) -> Sequence[int]:
    """The rows of the shapes whose sides are kept: of kinematic bodies only, unless `sided`."""
    if sided:
        return range(len(world.shapes))
    # Kinematic bodies have the rows of BODY after those of dynamic ones.
    found: list[int] = (world.IDS[BODY_ROW][world.owner] >= world.dynamic).nonzero()[0].tolist()
    return found


def sides_of(world: World, loop: EventLoop) -> Sides | None:
    """The remembered sides of a world; None if it has neither sides nor shapes of kinematic bodies."""
    known = loop.sides if loop.thin else None
    if known is not None and not (known["key"] > 0).any():
        known = None
    if known is None and len(world.BODY) - 1 <= world.dynamic:  # no kinematic body: most spaces
        return None
    matter = _that_matter(world, known is not None)
    return Sides(world, known, matter) if matter else None


def _outline(record: ShapeRecord | None) -> object:
    """Vertices and radius, for comparison."""
    return record and (record.vertices, record.numbers[0])


def _in_order(VERTEX: FloatArray, LINK: Rows[Link]) -> FloatArray:
    """The vertices of each shape sorted by coordinates: pymunk's pickles may begin a polygon with another corner."""
    of_shape = np.repeat(np.arange(len(LINK)), LINK["vertices"])
    ordered: FloatArray = VERTEX[np.lexsort((*VERTEX.T, of_shape))]
    return ordered
