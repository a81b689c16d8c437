"""Decisions of collision handlers about pairs of shapes: for one step (`Rules`), and beyond it (`Decisions`).

pymunk keeps the arbiter of two shapes for `collision_persistence` steps after they have separated; what handlers have
decided applies to the pair until then. After a return to an earlier state (`set_state`) arbiters of later steps do not
count, and `Decisions` has those that applied at that state.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk

from ..arrays import FloatArray
from ..compiled.records import Rows
from ..model.shapes import Shape
from .private import arbiters as private_arbiters
from .private import spaces as private
from .private.shapes import overlap
from .private.versions import processed

if TYPE_CHECKING:
    from .world import World

DECISION_COLUMNS = 7  # indices of both shapes in `space.shapes`; the law (4), see `Law`; age in steps

_NONE = -1.0, 0.0, 0.0, 0.0  # the law of shapes that do not collide
_SAME = 1e-9  # relative difference of a surface velocity and pymunk's tangential part of it that is round-off
ShapePair = tuple[int, int]
# Elasticity (-1: the shapes do not collide), friction, surface velocity (x, y) of b relative to a.
Law = tuple[float, float, float, float]


@dataclass(frozen=True)
class Rules:
    """Decisions of collision handlers about pairs of shapes (a, b), rows of SHAPE with a < b, for one step.

    `ignored`: pairs that do not collide.  `changed`: the laws of pairs that differ from those of their shapes.
    """

    ignored: frozenset[ShapePair] = frozenset()
    changed: Mapping[ShapePair, Law] = field(default_factory=dict)

    @classmethod
    def of_arbiters(cls, arbiters: Iterable[pymunk.Arbiter], world: World) -> Rules:
        """The decisions that arbiters of pymunk contain."""
        ignored, changed = set(), {}
        for arbiter in arbiters:
            a, b = (world.places.get(shape, -1) for shape in arbiter.shapes)
            if min(a, b) < 0:
                continue
            pair = (min(a, b), max(a, b))
            if not processed(arbiter):
                ignored.add(pair)
                continue
            own = _own_law(world.SHAPE, *pair)
            mu = 0.0 if world.frictionless else arbiter.friction
            surface = _surface(arbiter, own[2:], a < b)
            if not (0.0 <= mu < math.inf and math.isfinite(arbiter.restitution + sum(surface))):
                raise ValueError(
                    f"a collision handler has set friction {mu}, restitution {arbiter.restitution}, surface velocity "
                    f"{surface} of the shapes {arbiter.shapes}: give finite numbers, friction >= 0"
                )
            law = (max(arbiter.restitution, 0.0), mu, *surface)
            if law != own:
                changed[pair] = law
        return cls(frozenset(ignored), changed)

    def of_pairs(self, SHAPE: Rows[Shape], parted: Iterable[ShapePair] = ()) -> dict[ShapePair, Law]:
        """The laws of all these pairs, sorted. `parted` pairs do not collide, whatever handlers decide."""
        never = self.ignored.union(parted)
        return {
            pair: (-1.0, 0.0, *_own_law(SHAPE, *pair)[2:]) if pair in never else self.changed[pair]
            for pair in sorted(never.union(self.changed))
        }


NO_RULES = Rules()  # those of all steps in which no decision applies


def _own_law(SHAPE: Rows[Shape], a: int, b: int) -> Law:
    """What `..pairs.rules.law` computes for two shapes without rules, which Python cannot call: it is no entry."""
    e, mu = (float(SHAPE[k][a] * SHAPE[k][b]) for k in ("elasticity", "friction"))
    x, y = (float(SHAPE[k][b] - SHAPE[k][a]) for k in ("surface_x", "surface_y"))
    return e, mu, x, y


def _surface(arbiter: pymunk.Arbiter, own: tuple[float, float], ordered: bool) -> tuple[float, float]:
    """The surface velocity of an arbiter. pymunk stores only the tangential part of that of the shapes, `own`: if it is
    this up to round-off, no function has set another one, and the result is `own`. `ordered`: whether the arbiter's
    first shape has the smaller index."""
    found = arbiter.surface_velocity
    x, y = found if ordered else -found
    if (x, y) == own:
        return own
    n = arbiter.normal
    away = own[0] * n.x + own[1] * n.y
    off = math.hypot(own[0] - away * n.x - x, own[1] - away * n.y - y)
    return own if off <= _SAME * (math.hypot(*own) + math.hypot(x, y)) else (x, y)


class Decisions:
    """What handlers of a space have decided about pairs of shapes, beside what pymunk's arbiters have.

    Attributes:
        since: number of pymunk's step; arbiters whose shapes last touched up to then do not count.
        laws: of shapes (a, b) the law, and the number of pymunk's step in which they last touched.
        rejected: that number of the shapes that arbiters say do not collide, in the last step that has read these.
    """

    def __init__(self) -> None:
        self.since = -1
        self.laws: dict[tuple[pymunk.Shape, pymunk.Shape], tuple[Law, int]] = {}
        self.rejected: dict[frozenset[pymunk.Shape], int] = {}

    def forget(self, space: pymunk.Space) -> None:
        """Forget earlier steps."""
        self.since, self.laws, self.rejected = private.timestamp(space)(), {}, {}

    def rules(self, world: World) -> Rules:
        """The decisions that apply in a step, after pymunk's step has called the handlers: those of its arbiters, then
        `laws` of pairs without a newer arbiter."""
        space, places = world.space, world.places
        now, oldest = private.timestamp(space)(), self.since
        newest = [arbiter for arbiter in private.differing_arbiters(space) if private_arbiters.stamp(arbiter) > oldest]
        rules = Rules.of_arbiters(newest, world)
        self._prolong(world, newest, now)
        if not self.laws:
            return rules
        found = ((frozenset(a.shapes), private_arbiters.stamp(a)) for a in private.arbiters(space))
        stamps = {pair: step for pair, step in found if step > oldest}
        self.laws = {
            pair: (law, step)
            for pair, (law, step) in self.laws.items()
            if now - step < space.collision_persistence and stamps.get(frozenset(pair), -1) < step
        }
        earlier: dict[ShapePair, Law] = {}
        for (one, two), (law, _) in self.laws.items():
            a, b = places.get(one, -1), places.get(two, -1)
            if min(a, b) >= 0:
                earlier[min(a, b), max(a, b)] = law if a < b else (*law[:2], -law[2], -law[3])
        never = {pair for pair, law in earlier.items() if law[0] < 0.0}
        changed = {pair: law for pair, law in earlier.items() if pair not in never}
        return Rules(rules.ignored | never, {**rules.changed, **changed})

    def _prolong(self, world: World, newest: Iterable[pymunk.Arbiter], now: int) -> None:
        """Let shapes that do not collide, and that pymunk's step has not seen, count as touching in it if they overlap
        at its start: pymunk sees what overlaps at the end of free flight, which may be far away, as of a ball that
        bounces fast within a shape that lets it pass."""
        places, rows = world.places, world.bodies.row
        rejected = {frozenset(one.shapes): private_arbiters.stamp(one) for one in newest if not processed(one)}
        earlier = {frozenset(pair): step for pair, (law, step) in self.laws.items() if law[0] < 0.0}
        # Also those of the last step whose arbiters pymunk has removed in this one.
        known: dict[frozenset[Any], int] = self.rejected | earlier | rejected
        self.rejected = rejected
        for pair, step in known.items():
            if step < now and pair <= places.keys():  # sensors have no place
                one, two = sorted(pair, key=places.__getitem__)
                at = [rows.get(shape.body, -1) for shape in (one, two)]
                if min(at) >= 0 and overlap((one, two), [world.state[row].tolist() for row in at]):
                    self.laws[one, two] = _NONE, now

    def state(self, world: World) -> FloatArray:
        """(n, DECISION_COLUMNS) all decisions that apply, sorted; also rejections that are forgotten here, but which
        pymunk's arbiters have as long as the shapes touch: their age is too great to apply by themselves."""
        space = world.space
        now, shapes = private.timestamp(space)(), list(space.shapes)
        known: dict[tuple[pymunk.Shape, pymunk.Shape], tuple[Law, int]] = dict(self.laws)
        for arbiter in private.differing_arbiters(space):
            step = private_arbiters.stamp(arbiter)
            found = Rules.of_arbiters([arbiter], world)
            if step <= self.since:
                found, step = Rules(found.ignored), now - int(space.collision_persistence)
            for a, b in (*found.ignored, *found.changed):
                one, two = sorted(arbiter.shapes, key=world.places.__getitem__)
                if (one, two) not in known or known[one, two][1] < step:
                    known[one, two] = found.changed.get((a, b), _NONE), step
        at = {shape: k for k, shape in enumerate(shapes)}
        rows = [(at[a], at[b], *law, now - step) for (a, b), (law, step) in known.items() if a in at and b in at]
        return np.array(sorted(rows), float).reshape(-1, DECISION_COLUMNS)

    def recall(self, space: pymunk.Space, rows: FloatArray) -> None:
        """Return to a result of `state`. Rejections are also written to existing arbiters, because pymunk does not call
        `begin` again for shapes that touch, nor for the arbiters of a pickle."""
        self.forget(space)
        shapes, never = list(space.shapes), set()
        for a, b, e, mu, x, y, age in rows.tolist():
            pair = shapes[int(a)], shapes[int(b)]
            if age < space.collision_persistence:
                self.laws[pair] = (e, mu, x, y), self.since - int(age)
            if e < 0.0:
                never.add(frozenset(pair))
        for arbiter in private.arbiters(space) if never else ():
            if frozenset(arbiter.shapes) in never:
                private_arbiters.reject(arbiter)
