"""World: a pymunk space as packed arrays, read once; its moving state crosses in one batch call each way and step."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from functools import cached_property
from typing import Any, TypeAlias

import pymunk

from ..compiled.records import Rows, rows
from ..layout import BODY_ROW
from ..model.bodies import Body
from ..report import Details, nothing
from ..transfer import take
from . import private
from .bodies import Bodies
from .checks import rough_pair, settings
from .crossing import Crossing
from .joints import JointRows
from .noticed import clock, edited_since, edits
from .packing import Packed, Record, read
from .patching import patch
from .rehearsal import Rehearsal
from .shapes import Rules

Records: TypeAlias = dict[pymunk.Shape, Record | None]


class World(Crossing):
    """The bodies and solid shapes of one space; ValueError or UnsupportedFeature for what cannot be stepped.

    Masses, shapes and functions of bodies are read once. `current()` tells, in half a microsecond, whether settings and
    contents of the space are still those, and whether shapes and bodies were edited in place (`noticed.py`); moved
    static bodies and exchanged bodies show in what `gather` reads, which `transfer.take` tells.

    Args:
        space: any pymunk space.  ignore: what to step on without, see `check_ignored`.
        past: the world of the same space before. Bodies and shapes that have not changed since are not read again, and
            what joints remember of earlier steps is kept.

    Attributes:
        records: what the shapes of the space say of themselves, None for sensors.
        bodies: in pymunk's order, N with the static ones.  shapes: by row of SHAPE.
        owner: (k,) place in `bodies.items` of the body of every shape.
        BODY, SHAPE, LINK, VERTEX: see `..model`.  disks, dynamic: rows of BODY below which there are lone disks, and
            dynamic bodies; the rows from there to the last one, the ground, are kinematic.
        STATES, WALK, EXTRA, ENDS: what crosses the edge, see `layout.py`.
        gravity: length/time².  damping: pymunk's, 1 is none.
        ignores: whether there is friction that is ignored.
        collisions: whether the space has collision handlers.  hooked: whether it or its bodies have functions, or
            velocities are gone after each step.  plain: whether there is nothing of that, and no joints.
        rules: what collision handlers decided about pairs of rows of SHAPE for this step.
        smooth: whether friction is left out, that of handlers too.
        joints: the constraints of the space, None if it has none.  PARTNER: bodies of joints that have no row of BODY.
        read_at: `noticed.clock` when shapes and bodies were read.
        patches: how often `patch` has put edits into the rows.  packed: what lays these.
        parted: pairs of rows of SHAPE that pass through one another because joints of their bodies say so.
    """

    def __init__(
        self, space: pymunk.Space, ignore: Sequence[str] = (), past: World | None = None
    ) -> None:  # fmt: skip
        self._edits = edits(space)
        self._known = self._edits[0] - self._edits[1]
        fixed = space.sleep_time_threshold < math.inf
        stale = None if past is None else past.stale()
        known = None if past is None or stale is None else past
        self.read_at = clock()
        bodies = Bodies(space, fixed) if known is None else Bodies(space, fixed, known.bodies, stale or ())
        state = bodies.start
        bodies.check_finite(state)
        self.records: Records = _records(space, bodies, {} if known is None else known.records, stale or ())
        self.smooth = "friction" in ignore
        self.ignores = self.smooth and rough_pair([s for s, r in self.records.items() if r is not None]) is not None
        self.packed = packed = Packed(bodies, state, self.records)
        super().__init__(space, bodies, packed.BODY, packed.row, state)
        self.shapes, self.owner = packed.shapes, packed.owner
        self.SHAPE, self.LINK, self.VERTEX = packed.SHAPE, packed.LINK, packed.VERTEX
        if self.smooth:
            self.SHAPE["friction"] = 0.0
            self.BODY["friction"] = 0.0
        self.disks, self.dynamic = packed.disks, packed.dynamic
        self.patches = 0
        self.parted: set[tuple[int, int]] = set()
        self.rules = Rules()
        self._contents = self._count()
        self.joints: JointRows | None = None
        if past is not None and past.joints is not None:
            self.joints = past.joints
            self.recall(past)
        self.read_settings(anew=True)

    def read_settings(self, anew: bool = False) -> None:
        """Read the settings of the space, checked, and its joints if these are others, or if `anew`; and watch both
        from now on."""
        self.gravity, self.damping = settings(self.space)
        self._read_joints(anew)
        self._seen = [self._edits[0]]
        self._known = self._edits[0] - self._edits[1]
        self.collisions = bool(private.handlers(self.space))
        self._forget_rules()
        bodies = self.bodies
        functions = len(bodies.velocity_hooks) > 0 or len(bodies.position_hooks) > 0
        self.hooked = self.collisions or functions or self.damping == 0.0
        self.plain = not self.hooked and self.joints is None
        self.current = private.watch(self.space, self._edits, self._seen)

    def _forget_rules(self) -> None:
        if self.rules.some:
            self.rules = Rules()

    def _read_joints(self, anew: bool) -> None:
        past = self.joints
        if not self.space.constraints:
            self.joints, self.parted = None, set()
        elif anew or past is None or not past.is_of(self.space):
            rows = {b: r for b, r in zip(self.bodies.items, self.WALK[BODY_ROW].tolist(), strict=True) if r >= 0}
            self.joints = JointRows(self.space, rows, len(self.BODY), past)

    @cached_property
    def rehearsal(self) -> Rehearsal:
        """What steps with collision handlers need."""
        return Rehearsal(self)

    @cached_property
    def places(self) -> dict[pymunk.Shape, int]:
        """The row of SHAPE of every solid shape."""
        return {shape: k for k, shape in enumerate(self.shapes)}

    @cached_property
    def empty(self) -> Details:
        """The arrays of a report without contacts."""
        return nothing(self.bodies.items)

    def stale(self) -> set[Any] | None:
        """Shapes and bodies that may say else than they did: edited, in the space or outside, or weighed anew since
        shapes have come or gone; None if nobody knows."""
        found = edited_since(self.read_at)
        if found is None or self.same_things():
            return found
        for shape in self.records.keys() ^ set(self.space.shapes):
            record = self.records.get(shape)
            found.update((shape.body, record and record.body))
        return found

    def patch(self) -> tuple[bool, bool] | None:
        """See `patching.patch`; the settings of the space are read as well, and what pymunk has now is in BODY."""
        found = patch(self)
        if found is not None:
            self.patches += 1
            if "rehearsal" in self.__dict__:
                self.rehearsal.forget()
            self._seen[0] = self._edits[0]
            if self.current():
                self._known = self._edits[0] - self._edits[1]
                self._forget_rules()
            else:
                self.read_settings()
            self._take(0.0, 0.0, 1.0)
        return found

    def settle(self) -> None:
        """Let joints tell of the step, and take no notice of how pymunk rounds what was written to it."""
        joints = self.joints
        if joints is not None:
            joints.write()
            if self.eccentric and self.current():
                self.gather()
                self.left_as_read()

    @property
    def PARTNER(self) -> Rows[Body]:
        """(x,) bodies of joints that have no row of BODY."""
        return rows(Body, 0) if self.joints is None else self.joints.partners.PARTNER

    def part(self) -> bool:
        """Find out whose shapes pass through one another because joints of their bodies say so; whether others than
        before do."""
        joints = self.joints
        if joints is None or joints.parted is not None:
            return False
        parted: set[tuple[int, int]] = set()
        if pairs := joints.part():
            of: dict[pymunk.Body, list[int]] = {}
            for k, i in enumerate(self.owner.tolist()):
                of.setdefault(self.bodies.items[i], []).append(k)
            for a, b in pairs:
                parted.update((min(i, j), max(i, j)) for i in of.get(a, ()) for j in of.get(b, ()))
        if parted == self.parted:
            return False
        self.parted = parted
        self.void_forecasts()
        return True

    def told(self) -> dict[tuple[int, int], tuple[float, float, float, float]]:
        """What handlers and joints say of pairs of rows of SHAPE, see `Rules.of_pairs`."""
        return self.rules.of_pairs(self.SHAPE, self.parted)

    def _count(self) -> tuple[int, int, int, int]:
        return private.shapes_ever(self.space), len(self.space.shapes), len(self.space.bodies), self._edits[1]

    def same_things(self) -> bool:
        """Whether shapes have neither come nor gone, and as many bodies are there; they may be others, and edited."""
        return self._contents == self._count()

    def edited(self) -> bool:
        """Whether a shape or body was edited in place."""
        return self._edits[0] - self._edits[1] != self._known

    def load(self) -> None:
        """Put what pymunk has now into BODY."""
        self.gather()
        self._take(0.0, 0.0, 1.0)

    @cached_property
    def _take(self) -> Callable[[float, float, float], int]:
        return take.bind(self.STATES, self.WALK, self.EXTRA, self.BODY)

    def left(self, dt: float) -> float:
        """What half a step's damping leaves of velocities; all of them where nothing is left at the end (`alter`)."""
        return self.damping ** (0.5 * dt) if self.damping > 0.0 else 1.0


def _records(space: pymunk.Space, bodies: Bodies, known: Records, stale: Collection[Any]) -> Records:
    """What every shape says, None for sensors; those that are known, and not `stale`, are not asked again.

    A shape whose body was taken out of the space is left as a wall where it is: pymunk too finds it there.
    """
    records: Records = {}
    for shape in space.shapes:
        before = known.get(shape) if shape not in stale else None
        if before is not None and not before.outside and before.body in bodies.row:
            records[shape] = before
        elif shape.sensor:
            records[shape] = None
        else:
            here = shape.body is None or shape.body in bodies.row
            records[shape] = read(shape, None if here else space.static_body)
    return records
