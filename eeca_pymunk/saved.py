"""Saved: what a pickled stepper has of the results of earlier steps, so that the copy continues bit by bit."""

from __future__ import annotations

import pickle
from collections.abc import Iterator, Sequence
from io import BytesIO

import numpy as np

from .arrays import AnyArray, BoolArray, FloatArray
from .compiled.records import Rows, columns
from .compiled.sources import sources_hash
from .impacts.scene import EventLoop
from .layout import BODY_ROW, WRITTEN
from .model.bodies import MOBILITY, OF_SHAPES
from .model.joints import OF_STEPS, PIVOT, RATCHET, Joint
from .model.shapes import Link
from .space.decisions import Decisions
from .space.world import World

_TIE = "kind", "body", "finite_force"  # fields of JOINT that decide the plan of the components


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
        # After edits that steps refuse, or within a step, the copy reads all joints again.
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
            elif name == "kind":
                for j in joints.measured():  # a pin of length 0 is a pivot
                    unequal[j] = unequal[j] and method.joint[j].kind != PIVOT
            if name not in _TIE:
                unequal[joints.functions] = False
            differs |= unequal
        return not differs.any()


def _in_order(VERTEX: FloatArray, LINK: Rows[Link]) -> FloatArray:
    """The vertices of each shape sorted by coordinates: pymunk's pickles may begin a polygon with another corner."""
    of_shape = np.repeat(np.arange(len(LINK)), LINK["vertices"])
    ordered: FloatArray = VERTEX[np.lexsort((*VERTEX.T, of_shape))]
    return ordered
