"""Rounds: the impacts of a step in vectorised rounds, each of which takes what no earlier impact can change."""

from __future__ import annotations

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, put_rows
from ..closures.motion import Start
from ..space.bodies import Bodies
from ..space.twin import MarginTwin
from .agenda import Agenda
from .blocks import Blocks
from .contacts import ROUND_OFF, Pairs, touching
from .forecast import missed, next_impact
from .impacts import Impacts, Log
from .memory import Memory, Saved, carried
from .paths import Paths

_SHORTEST = 2.0**-20  # part of dt, of a window within which the order of impacts is checked
_COARSE = 16.0  # times the round-off of the largest lengths, above which no gap is that of shapes that touch
_SQUEEZED = 50  # impacts of one contact with a moving wall in a step
_BOUNCES = 16  # of one contact within a step after which it stops if its elasticity is below 1


class Rounds:
    """The impacts of one step, in rounds. Contacts are numbered by their place in the list of pairs."""

    def __init__(
        self, bodies: Bodies, start: Start, twin: MarginTwin, pairs: Pairs, slack: FloatArray, log: Log
    ) -> None:
        self.log = log
        self.start, self.twin, self.slack = start, twin, slack
        self.moves: BoolArray = bodies.dynamic
        self.paths = Paths(start, np.flatnonzero(bodies.dynamic))
        self.impacts = Impacts(bodies, start, self.paths, log, twin.shapes)
        self.blocks = Blocks(self.impacts)
        self.squeezes = bool(self.impacts.kinematic.any())
        self.may_stop = start.pulled or twin.shapes.lossy
        self.agenda = Agenda(self.paths, self.moves, start.dt)
        self.window = 1.0  # the first one, as part of the step
        near = self._remember(pairs)
        if near is None:
            near = self._list(pairs, np.zeros(0, np.intp))
        if len(near):
            self._begin(near)

    def _list(self, pairs: Pairs, touch: IntArray) -> IntArray:
        """Take a list of pairs; `touch` are the keys of those that touch.

        Returns the contacts that are closed.
        """
        self.agenda.pairs = pairs
        self.agenda.time, self.agenda.gap = next_impact(pairs, self.paths, np.arange(len(pairs)), self.start.dt)
        self.bounces: IntArray = np.zeros(len(pairs), np.intp)
        self.agenda.touch = np.searchsorted(pairs.key, touch)
        if (held := self._held()) is not None:
            self._forecast(np.flatnonzero(held >= 0.0))
        self._wait()
        self.agenda.join()
        near = np.flatnonzero(self._may_touch(np.arange(len(pairs))))
        return near[self.agenda.gap[near] <= touching(pairs.take(near), self.start.position)] if len(near) else near

    def _may_touch(self, which: IntArray) -> BoolArray:
        """(m,) whether the gaps of pairs `which`, just looked at, are round-off of the largest lengths there are."""
        coarse = _COARSE * ROUND_OFF * (np.abs(self.start.position).max() + self.twin.shapes.size.max())
        may: BoolArray = self.agenda.gap[which] <= coarse
        return may

    def _remember(self, pairs: Pairs) -> IntArray | None:
        """Take the forecasts of the last step, which hold for all bodies that nobody has touched since.

        Returns the contacts that may be closed; None if nothing is remembered.
        """
        last = self.twin.memory
        if not isinstance(last, Memory):
            return None
        last, start = last.about(pairs), self.start
        self.window = last.window
        self.agenda.pairs, self.agenda.time, self.agenda.gap = pairs, last.time, last.gap
        self.bounces = np.zeros(len(pairs), np.intp)
        self.agenda.touch = np.zeros(0, np.intp)
        self.agenda.join()
        changed = self.paths.changed(last.position, last.velocity, last.acceleration)
        near = last.touch
        # What is due is found anew too: a run that was saved and resumed, and remembers nothing, has the same instants.
        known = (self.agenda.time >= start.dt) & ~(changed[pairs.row_a] | changed[pairs.row_b])
        again = np.flatnonzero(~known)
        # General shapes that touch are looked at when it is known how they go on.
        again = again[~np.isin(again, near[np.searchsorted(near, pairs.flat) :])]
        self._forecast(again)
        near = np.union1d(near, again[self._may_touch(again)])
        if len(near) == 0:
            return near
        some = pairs.take(near)
        touches = some.at(start.position).gap <= touching(some, start.position)
        if pairs.flat < len(pairs):
            self._forecast(near[~touches])
        return near[touches]

    def _extend(self, pairs: Pairs, taken: IntArray) -> IntArray:
        """Take another list of pairs, and forecast what is new in it; where the contacts `taken` are there."""
        agenda = self.agenda
        place, count = agenda.pairs.places_in(pairs), len(pairs)
        agenda.time, agenda.gap = carried(agenda.time, place, count, np.nan), carried(agenda.gap, place, count, np.inf)
        self.bounces = carried(self.bounces, place, count, -1)
        agenda.pairs, agenda.touch = pairs, place[agenda.touch]
        new = np.flatnonzero(self.bounces < 0)
        self.bounces[new] = 0
        self._forecast(new)
        return place[taken]

    def _forecast(self, which: IntArray) -> None:
        """Look anew at the pairs `which` (increasing)."""
        if len(which):
            agenda = self.agenda
            agenda.time[which], agenda.gap[which] = next_impact(
                agenda.pairs, self.paths, which, self.start.dt, self._held()
            )

    def _begin(self, near: IntArray) -> None:
        """The contacts that touch at the start form blocks with what hits them there, and may rest."""
        self.agenda.touch = near
        self.agenda.join()
        self._strike(near, np.zeros(len(near)))
        self._look_again(near)

    def run(self, max_rounds: int) -> tuple[FloatArray, FloatArray]:
        """Rounds until nothing is due within the step; velocities and displacements (N, 2)."""
        start, paths = self.start, self.paths
        dt, rounds, windows = start.dt, 0, 1
        begin, end = 0.0, dt * self.window
        saved, shortest, restored = self._save(), end, False
        while rounds < max_rounds:
            due = np.flatnonzero(self.agenda.time < end)
            if len(due) == 0:
                if end == dt:
                    break
                begin, end = end, min(dt, end + 2.0 * (end - begin))
                windows += 1
                saved = self._save()
                continue
            rounds += 1
            if not self._look_again(self._take(due)) and end - begin > _SHORTEST * dt:
                self._restore(saved)
                end = begin + 0.5 * (end - begin)
                shortest, restored = min(shortest, end - begin), True
        # Who met nobody moves by the same round-off whether others were near or not.
        kinked = np.flatnonzero(paths.changed(start.position, start.velocity, start.acceleration))
        displacement = start.free_displacement
        moved = paths.position(kinked, np.full(len(kinked), dt)) - start.position.take(kinked, axis=0)
        put_rows(displacement, kinked, moved)
        self.blocks.finish()
        velocity = paths.rate(self.agenda.rows, np.full(len(self.agenda.rows), dt))
        self.twin.memory = Memory(
            self.agenda.pairs, self.agenda.time - dt, self.agenda.gap, self.agenda.touch,
            start.position + displacement, velocity, paths.acceleration,
            shortest / dt if restored else min(2.0 * shortest / dt, 1.0),
        )  # fmt: skip
        self.log.rounds += rounds
        self.log.windows += windows
        self.log.converged &= len(due) == 0
        return velocity, displacement

    def _take(self, due: IntArray) -> IntArray:
        """One round: apply the impulses of the earliest contacts among `due`; the contacts it took."""
        lone, block = self.agenda.choose(due)
        if len(lone):
            meeting = self.impacts.meet(self.agenda.pairs.take(lone), self.agenda.time[lone])
            stops = np.zeros(len(lone), bool)
            stops[meeting.faces] = True  # which meet at two points
            if self.may_stop:
                elasticity = meeting.pairs.elasticity
                stops |= self.impacts.stays(meeting.pairs, elasticity * meeting.approach) | self._spent(lone)
            if stops.any():
                block, lone = np.union1d(block, lone[stops]), lone[~stops]
                meeting = meeting.take(np.flatnonzero(~stops))
            self.bounces[lone] += 1
            self.impacts.bounce(meeting)
        if len(block) == 0:
            return lone
        self._strike(block, np.where(np.isin(block, due), self.agenda.time[block], np.inf))
        return np.concatenate((lone, block))

    def _strike(self, block: IntArray, seed: FloatArray) -> None:
        """Solve blocks (contacts, increasing) hit at the instants `seed`, and remember what touches on."""
        on = self.blocks.strike(self.agenda.pairs.take(block), seed, self._spent(block))
        self.agenda.touch = np.union1d(np.setdiff1d(self.agenda.touch, block), block[on])
        self.bounces[block] += 1
        self.agenda.join()

    def _wait(self) -> None:
        """What touches does nothing until something hits it, or until the force it rests on has to be found anew, or
        until another corner comes down."""
        agenda, resting = self.agenda, self.blocks.resting
        agenda.time[agenda.touch[: np.searchsorted(agenda.touch, agenda.pairs.flat)]] = np.nan
        if len(resting.key):
            rests = np.searchsorted(agenda.pairs.key, resting.key)
            agenda.time[rests] = np.fmin(agenda.time[rests], resting.until)

    def _held(self) -> FloatArray | None:
        """(P,) the speed below which points of pairs that touch stay in touch; None where no general pair does."""
        touch, pairs = self.agenda.touch, self.agenda.pairs
        touch = touch[np.searchsorted(touch, pairs.flat) :]
        if len(touch) == 0:
            return None
        slow = self.impacts.slow
        held = np.full(len(pairs), -np.inf)
        held[touch] = np.maximum(slow[pairs.row_a[touch]], slow[pairs.row_b[touch]])
        return held

    def _spent(self, contacts: IntArray) -> BoolArray:
        """Whether a contact has bounced so often that it has to stop, so that no dissipating bounce goes on forever."""
        spent: BoolArray = (self.bounces[contacts] >= _BOUNCES) & (self.agenda.pairs.elasticity[contacts] < 1.0)
        return spent

    def _look_again(self, taken: IntArray) -> bool:
        """Forecast anew what the bodies of the contacts just taken meet.

        Returns False if one of them would have met a body before an impact of that body that was taken already.
        """
        pairs, paths = self.agenda.pairs, self.paths
        both = np.concatenate((pairs.row_a[taken], pairs.row_b[taken]))
        rows = both[self.moves[both]]
        changed = np.zeros(len(self.agenda.rows), bool)
        changed[rows] = True
        moved = paths.position(rows, np.full(len(rows), self.start.dt)) - self.start.position.take(rows, axis=0)
        if not self.twin.covers(rows, moved, self.slack[rows]):
            # An impulse sent a body farther than its margin: pairs that were not near may meet now.
            taken = self._extend(self.twin.widen(self.start.position), taken)
            pairs = self.agenda.pairs
        again = np.flatnonzero(changed[pairs.row_a] | changed[pairs.row_b])
        if missed(pairs, paths, again, changed):
            return False
        self._forecast(again)
        if self.may_stop:
            at_once = self.agenda.time[taken] <= np.maximum(
                paths.since[pairs.row_a[taken]], paths.since[pairs.row_b[taken]]
            )
            at_once &= self.bounces[taken] >= _BOUNCES
            self.agenda.time[taken[at_once]] = np.nan
        if self.squeezes:
            # Between moving walls that close in a body would be hit ever faster: what is left is for the next step.
            self.agenda.time[self.impacts.kinematic[pairs.row_b] & (self.bounces >= _SQUEEZED)] = np.nan
        self._wait()
        return True

    def _save(self) -> Saved:
        paths, before, agenda = self.paths.copy(), self.paths.before.copy(), self.agenda
        return Saved(
            paths, before, agenda.pairs, agenda.time.copy(), self.bounces.copy(), agenda.touch, self.blocks.resting,
            self.log.lock, len(self.log),
        )  # fmt: skip

    def _restore(self, saved: Saved) -> None:
        self.paths.assign(saved.paths)
        self.paths.before.assign(saved.before)
        self.agenda.touch, self.blocks.resting = saved.touch, saved.resting
        self.log.lock = saved.lock
        self.log.forget(saved.log)
        if self.agenda.pairs is saved.pairs:
            self.agenda.time[:], self.bounces[:] = saved.time, saved.bounces
            self.agenda.join()
        else:
            # The longer list serves the shorter paths as well.
            self._list(self.agenda.pairs, saved.pairs.key[saved.touch])
