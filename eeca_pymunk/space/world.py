"""World: a pymunk space as packed arrays, read once; states are read and written in one batch call each per step."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from functools import cached_property, partial
from typing import Any

import pymunk

from ..arrays import BoolArray
from ..impacts.edits import Changes, Edits
from ..impacts.scene_memory import Laid, SceneMemory
from ..layout import BODY_ROW, KNOWN_ID
from ..report import nothing
from .bodies import Bodies
from .body_states import BodyStates
from .checks import has_friction, settings
from .decisions import NO_RULES
from .edits import Counts, clock, counts, edited_since
from .hooks import Hooks
from .joints import JointRows
from .packing import Packed, ShapeRecords, records_of, shape_counts
from .patching import patch
from .private import spaces as private
from .rehearsal import Rehearsal


class World(BodyStates):
    """The bodies and solid shapes of one space; ValueError or UnsupportedFeature if it cannot be stepped.

    Masses, shapes and functions of bodies are read once. `current()` returns, within a tenth of a microsecond, whether
    settings of the space have not changed, nothing was added or removed, and no shape or body was edited in place
    (`edits.py`). Moved static bodies and exchanged bodies are found by `transfer.read_states` in the states that
    `gather` reads.

    Args:
        space: any pymunk space.  ignore: features to leave out, see `check_ignored`.
        past: the world of the same space before. Bodies and shapes that have not changed since are not read again, and
            results of earlier steps for joints are kept.

    Attributes, beside those of `BodyStates`:
        records: the values of the shapes of the space, None for sensors.
        shapes: by row of SHAPE.  owner: (k,) index in `bodies.items` of the body of each.
        SHAPE, LINK, VERTEX: see `..model`.  disks, dynamic: BODY[:disks] are single disks, BODY[disks:dynamic]
            other dynamic bodies; then come kinematic bodies, and last the ground, which has all static shapes.
        gravity: length/time².  damping: pymunk's, the factor on velocities in one second; 1 is none.
        without_contacts: function that makes the arrays of a report without contacts.
        hooks: functions of bodies and constraints.  collisions: whether the space has collision handlers.
        hooked_steps: whether its steps are hooked whatever its joints are, by functions of bodies or handlers, or as
            damping is 0.  only_handlers: whether collision handlers are the only functions.  plain: neither hooked
            steps nor joints.
        rules: decisions of collision handlers about pairs of rows of SHAPE in this step.
        frictionless: whether friction, also that of handlers, is left out.  lacks_friction: and the space has some.
        joints: the constraints of the space, None if it has none.
        undecided: whether no decision of a handler can apply, see `Rehearsal.go_on`.
        sleeps: whether bodies could sleep when it was read.  read_at: `edits.clock` when shapes and bodies were read.
        patches: number of patches so far.  packed: the arrays of the rows, and the kernel that writes them.
        objects_read: number of bodies, shapes and constraints read from pymunk for this world; others were known.
        memory: of the scene of its event loop.  void: whether a patch has failed and left invalid rows.
        parted: pairs of rows of SHAPE that do not collide, by `collide_bodies` of a joint of their bodies.
    """

    packed: Packed
    _edits: Counts

    def __init__(self, space: pymunk.Space, ignore: Sequence[str] = (), past: World | None = None) -> None:
        self.space, self._edits = space, counts(space) if past is None else past._edits
        self._known, self._contents = self._edits.in_place, self._edits[1::2]
        self.sleeps = space.sleep_time_threshold < math.inf
        stale = None if past is None else past.stale()
        known = None if stale is None else past
        self.read_at = clock()
        super().__init__(space, past)
        bodies = Bodies(space, self.sleeps, None if known is None else known.bodies, stale or (), self.IDS[KNOWN_ID])
        self.bodies = bodies
        self.records: ShapeRecords
        self.records, count = records_of(space, bodies, {} if known is None else known.records, stale or ())
        self.objects_read = bodies.fresh + count
        self.memory: SceneMemory = SceneMemory() if past is None else past.memory
        self.frictionless = "friction" in ignore
        self.lacks_friction = self.frictionless and has_friction([s for s, r in self.records.items() if r is not None])
        self.packed = packed = Packed(bodies, self, self.records, None if past is None else past.packed)
        if packed.status < 0:
            bodies.check_finite(self.state)
        self.bind(packed.table, packed.bound)
        self.shapes, self.owner = packed.shapes, packed.owner
        self.BODY, self.SHAPE, self.LINK, self.VERTEX = packed.BODY, packed.SHAPE, packed.LINK, packed.VERTEX
        if self.frictionless:
            self.SHAPE["friction"] = 0.0
            self.BODY["friction"] = 0.0
        self.disks, self.dynamic, self._moving_shapes, _, eccentric, *self._functions = packed.totals
        self.eccentric = eccentric > 0
        self.patches = 0
        self.parted: set[tuple[int, int]] = set()
        self.rules = NO_RULES
        self.without_contacts = partial(nothing, self.bodies.items)
        self.joints: JointRows | None = None
        self.void = False
        if past is not None:
            self.joints = past.joints
            self.recall(past)
        self.read_settings(True, stale)
        self.undecided = False
        if past is not None and (rehearsal := past.__dict__.pop("rehearsal", None)) is not None:
            self.undecided, self.rehearsal = rehearsal.go_on(self), rehearsal

    def read_settings(self, anew: bool = False, stale: Collection[Any] | None = None) -> None:
        """Read and check the settings of the space, and its joints if they have changed or if `anew`; record later
        changes. `stale`: the result of this method, in a new world."""
        self.gravity, self.damping = settings(self.space)
        self._read_joints(anew, stale)
        self._seen = [self._edits[0]]  # a list, because `current` reads its later values
        self._known = self._edits.in_place
        self.collisions = bool(private.handlers(self.space))
        if "rehearsal" in self.__dict__:
            self.rehearsal.forget_old_handlers()
        self.rules = NO_RULES
        self.hooks = Hooks(self.space, self.bodies, self.joints, *self._functions)
        self.hooked_steps = self.collisions or self.hooks.any_body or self.damping == 0.0
        self.only_handlers = self.collisions and not self.hooks.any_body
        self.plain = not self.hooked_steps and self.joints is None
        self.current = private.watch(self.space, self._edits, self._seen)

    def half_damping(self, dt: float) -> float:
        """The factor of half a step's damping on velocities; 1 if that is 0, for which `alter_end` stops the bodies."""
        return float((self.damping or 1.0) ** (0.5 * dt))

    def _read_joints(self, anew: bool, stale: Collection[Any] | None) -> None:
        past = self.joints
        if not self.space.constraints:
            self.joints = None
        elif anew or past is None or past.items != list(self.space.constraints):
            rows = {b: r for b, r in zip(self.bodies.items, self.IDS[BODY_ROW].tolist(), strict=True) if r >= 0}
            if past is None or not past.renumber(rows, len(self.BODY), stale):
                self.joints = past = JointRows(self.space, rows, len(self.BODY), past)
            self.objects_read += len(past.fresh)

    @property
    def laid(self) -> Laid:
        """The rows for a scene."""
        return Laid(self.BODY, self.SHAPE, self.LINK, self.VERTEX, self.disks, self.packed.measured())

    @cached_property
    def rehearsal(self) -> Rehearsal:
        """Arrays and wrappers for steps with collision handlers."""
        return Rehearsal(self)

    @cached_property
    def places(self) -> dict[pymunk.Shape, int]:
        """The row of SHAPE of each solid shape."""
        return dict(zip(self.shapes, range(len(self.shapes)), strict=True))

    @property
    def centred(self) -> BoolArray:
        """(k,) whether a moving shape is a disk about the centre of mass of its body."""
        centred: BoolArray = (self.LINK["vertices"] == 1) & ~self.VERTEX[self.LINK["first"], :2].any(axis=1)
        return centred

    @cached_property
    def moving_shapes(self) -> int:
        """Number of shapes of bodies that are not static."""
        if len(self.shapes) == len(self.records):
            return self._moving_shapes
        return sum(shape_counts(self.bodies, self.records).values())  # with sensors

    @cached_property
    def movers(self) -> list[Any]:
        """Pointers to the Chipmunk bodies that are not static and have shapes, when they were read; `late_shapes`
        moves those that the space has by now."""
        if len(self.shapes) == len(self.records):
            items = self.bodies.items
            return private.pointers([items[i] for i in sorted(set(self.owner[: self._moving_shapes].tolist()))])
        return private.pointers(body for body, count in shape_counts(self.bodies, self.records).items() if count)

    def stale(self) -> set[Any] | None:
        """Shapes and bodies to be read again: those edited, in the space or outside, and the bodies of shapes that were
        added or removed, whose mass may have changed; None if unknown."""
        edited = edited_since(self.read_at)
        found = None if edited is None else edited.things
        if found is None or self.same_things():
            return found
        for shape in self.records.keys() ^ set(self.space.shapes):
            record = self.records.get(shape)
            found.update((shape.body, record and record.body))
        return found

    def patch(self, in_values: bool, surfaces: bool) -> Edits | Changes | None:
        """`patching.patch`, then the settings of the space if these have changed, and the present states if rows were
        written."""
        found = patch(self, in_values, surfaces or self.joints is not None)
        if found is None:
            return None
        self.patches += 1
        if "rehearsal" in self.__dict__:
            self.rehearsal.forget(reshaped=not isinstance(found, Edits) or bool(found.filters))
        self._seen[0] = self._edits[0]
        if self.current():
            self._known = self._edits.in_place
            self.rules = NO_RULES
        else:
            self.read_settings()
        if not isinstance(found, Edits):
            self.read_states(0.0, 0.0, 1.0)
        return found

    def show_joints(self, joints: JointRows) -> None:
        """Let the program read impulses and notches of the step. Also, where pymunk has rounded positions as it wrote
        them (`eccentric`), accept these as unedited."""
        joints.write()
        # Where the step has called no function, nothing can have changed.
        if self.eccentric and (not (self.hooked_steps or joints.functions or joints.calling) or self.current()):
            self.gather()
            self.accept_rounding()

    def find_parted(self) -> bool:
        """Find the pairs of shapes that do not collide because of joints of their bodies; returns whether they have
        changed."""
        joints = self.joints
        if joints is not None and joints.parted is not None:
            return False
        parted = set() if joints is None else joints.find_parted(self.owner, self.bodies.items)
        if parted == self.parted:
            return False
        self.parted = parted
        self.void_predictions()
        return True

    def laws(self) -> dict[tuple[int, int], tuple[float, float, float, float]]:
        """The laws of pairs of rows of SHAPE by handlers and joints, see `Rules.of_pairs`."""
        return self.rules.of_pairs(self.SHAPE, self.parted)

    def same_things(self) -> bool:
        """Whether no shape or body was added, removed or put to sleep (counts 3 and 1 of `edits.Counts`)."""
        return self._contents == self._edits[1::2]

    def edited(self) -> bool:
        """Whether a shape or body was edited in place."""
        return self._edits.in_place != self._known
