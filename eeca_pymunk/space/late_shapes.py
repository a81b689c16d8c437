"""Shapes that are moved to their bodies only when something reads them.

pymunk's shapes have a pose of their own, which queries, bounding boxes and pictures read, and which costs as much to
update as a step of a few bodies takes. A step of EECA therefore only says that the shapes are late (`Late`), and the
methods of pymunk that read them, replaced here, first move them to the present poses of their bodies. pymunk's own step
does that anyway. What leaves a space is moved before.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary, ref

import pymunk

from .bodies import moving
from .edits import clock, counts
from .private import shapes as private_shapes
from .private import spaces as private
from .private import versions as private_versions

if TYPE_CHECKING:
    from .sync import Sync


# Number of moving shapes up to which those of a spatial hash are reindexed if they are read after each step. Measured,
# steps with reindexing to those with a rest step, of 10, 30, 100 and 1000 disks: in a hash 1.1, 1.1, 2.5 and 11 in a
# gas, .7, 1, 1.2 and 3.4 in a pile; in a tree .8 to 1.3 for any number, and .8 for boxes that touch.
MOST_READ = 16


class Late:
    """What is known of the shapes of a space.

    Attributes:
        late: whether they are behind their bodies, unless pymunk has taken a step since its step number `stamp`.
        read: whether something has read them since this was last set to False.
        hashed: whether the space has a spatial hash. One that has got it before this package was imported is not known
            to have it, which costs time only.
        reindexings: of one with a hash: how many may still follow, until the next rest step, see `REINDEXINGS`.
        sync: of the last EECA step, of whichever stepper.
    """

    __slots__ = ("_contents", "_movers", "hashed", "late", "read", "reindexings", "stamp", "sync")

    def __init__(self) -> None:
        self.late, self.read, self.hashed, self.stamp, self.reindexings = False, False, False, -1, 0
        self.sync: ref[Sync] | None = None  # weak: it refers to the space, which is a key of `_known`
        # Pointers to the bodies with shapes that are not static, and the contents of the space when they were found.
        self._movers: list[Any] = []
        self._contents: tuple[int, ...] = ()

    def move(self, space: pymunk.Space) -> None:
        """Move the shapes to their bodies, unless pymunk has done so, in a step that it has begun since. Within such a
        step nothing can be reindexed."""
        self.late = False
        if private.timestamp(space)() == self.stamp:
            self.reindexings -= 1
            contents = counts(space)[3], clock()
            if contents != self._contents:
                # Those of `World.movers` may be of an earlier reading.
                self._movers = private.pointers(body for body in moving(space) if body.shapes)
                self._contents = contents
            private_shapes.reindex(space, self._movers)


_known: WeakKeyDictionary[pymunk.Space, Late] = WeakKeyDictionary()
_replaced = False  # whether pymunk's methods were
_OF_SPACE = "point_query", "point_query_nearest", "segment_query", "segment_query_first", "bb_query", "shape_query"
_OF_SHAPE = "point_query", "segment_query", "shapes_collide"


def late_shapes(space: pymunk.Space) -> Late:
    """What is known of the shapes of a space, to be changed by who moves its bodies."""
    global _replaced
    if not _replaced:
        _replaced = True
        _replace_readers()
    if (known := _known.get(space)) is None:
        known = _known[space] = Late()
    return known


def move_late(space: pymunk.Space | None) -> None:
    """Move the shapes of a space to their bodies if they are late; before something reads them."""
    if space is None or (known := _known.get(space)) is None:
        return
    known.read = True
    if known.late:
        known.move(space)


def last_sync(space: pymunk.Space) -> Sync | None:
    """The `Sync` of the last EECA step of a space, None if its stepper is gone or has read the space anew."""
    known = _known.get(space)
    return None if known is None or known.sync is None else known.sync()


def make_arbiters(space: pymunk.Space) -> None:
    """Let pymunk's arbiters be those of the last step: for a picture, or before bodies fall asleep."""
    if (sync := last_sync(space)) is not None:
        sync.renew(read=False)


def _replace_readers() -> None:
    for name in _OF_SPACE:
        setattr(pymunk.Space, name, _reader(getattr(pymunk.Space, name), lambda space: space))
    for name in _OF_SHAPE:
        setattr(pymunk.Shape, name, _reader(getattr(pymunk.Shape, name), lambda shape: shape.space))
    native: Any = pymunk.Shape.bb
    pymunk.Shape.bb = property(_reader(native.fget, lambda shape: shape.space), doc=native.__doc__)  # type: ignore
    remove = private_versions.REMOVE
    setattr(pymunk.Space, remove, _remove(getattr(pymunk.Space, remove)))


def _note_hash(native: Callable[..., None]) -> Callable[..., None]:
    @wraps(native)
    def use_spatial_hash(self: pymunk.Space, *args: Any, **more: Any) -> None:
        native(self, *args, **more)
        _known.setdefault(self, Late()).hashed = True

    return use_spatial_hash


def _reader(native: Callable[..., Any], space_of: Callable[[Any], pymunk.Space | None]) -> Callable[..., Any]:
    """A method that reads shapes, after they were moved."""

    @wraps(native)
    def read(self: Any, *args: Any, **more: Any) -> Any:
        move_late(space_of(self))
        for other in args[:1]:  # `shapes_collide` and `shape_query` read another shape too
            if isinstance(other, pymunk.Shape):
                move_late(other.space)
        return native(self, *args, **more)

    return read


def _remove(native: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(native)
    def remove(self: pymunk.Space, *objects: Any) -> None:
        # All shapes are moved: within `native` handlers of `separate` may be called, and nothing can be reindexed.
        if any(not isinstance(item, pymunk.Constraint) for item in objects):
            move_late(self)
        native(self, *objects)

    return remove


pymunk.Space.use_spatial_hash = _note_hash(pymunk.Space.use_spatial_hash)  # type: ignore[method-assign]
