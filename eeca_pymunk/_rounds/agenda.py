"""Agenda: what is due when, and which of it is next (design section 4)."""

from __future__ import annotations

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..energy.graph import components
from .contacts import Pairs, touching
from .features import length
from .paths import Paths

_TIE = 1e-6  # part of dt within which two impacts of one body may be the same instant up to round-off of places
_WAIT = 6.0  # how much faster than now an impact may make a body, in the guess of `_mind_neighbours`


class Agenda:
    """The times of impact of a list of pairs, and the contacts that no earlier impact can change.

    Attributes:
        pairs: the P pairs; contacts are numbered by their place among them.
        time: (P,) next impact, after the start of the step; NaN where the pair waits for others, infinity if never.
        gap: (P,) length, when the pair was last looked at.
        touch: contacts (increasing) that touch, or did when they were last looked at.
        label: (N,) the same for bodies that touch each other.  rows: (N,) the bodies.
    """

    pairs: Pairs
    time: FloatArray
    gap: FloatArray
    touch: IntArray

    def __init__(self, paths: Paths, moves: BoolArray, dt: float) -> None:
        self.paths, self.moves, self.dt = paths, moves, dt
        self.rows: IntArray = np.arange(len(moves))
        self.label = self.rows

    def join(self) -> None:
        """Bodies that touch wait for each other: what hits one of them hits all."""
        self.label = self.rows
        if len(self.touch):
            self.label = components(self.pairs.row_a[self.touch], self.pairs.row_b[self.touch], self.moves)

    def choose(self, due: IntArray) -> tuple[IntArray, IntArray]:
        """Of the contacts `due` those that are next and act alone, and those that are next and act in blocks."""
        t = self.time[due]
        a, b = self._labels(due)
        earliest = np.full(len(self.rows), np.inf)
        np.minimum.at(earliest, a, t)
        np.minimum.at(earliest, b, t)
        earliest[~self.moves] = np.inf  # a wall waits for nobody
        self._mind_neighbours(earliest)
        wait = np.maximum(t - earliest[a], t - earliest[b])
        nearly = due[(wait > 0.0) & (wait <= _TIE * self.dt)]
        return self._split(due[wait <= 0.0], self._ties(nearly, earliest))

    def _mind_neighbours(self, earliest: FloatArray) -> None:
        """Let bodies wait for impacts of neighbours that may send these into them before their own: (N,) instants.

        A guess from speeds and gaps, which saves rounds; `missed` finds what it did not foresee.
        """
        busy = earliest < np.inf
        both = np.flatnonzero(busy[self.pairs.row_a] & busy[self.pairs.row_b])
        row_a, row_b = self.pairs.row_a[both], self.pairs.row_b[both]
        fast = length(self.paths.velocity)
        speed = fast[row_a] + fast[row_b]
        a, b = self.label[row_a], self.label[row_b]
        t_a, t_b = earliest[a], earliest[b]
        soon = np.flatnonzero(self.gap[both] < _WAIT * speed * np.abs(t_a - t_b))
        np.minimum.at(earliest, a[soon], t_b[soon])
        np.minimum.at(earliest, b[soon], t_a[soon])

    def _ties(self, nearly: IntArray, earliest: FloatArray) -> IntArray:
        """Those of the contacts that are closed already, up to round-off, at the earliest instant of their bodies."""
        if len(nearly) == 0:
            return nearly
        chosen = self.pairs.take(nearly)
        a, b = self._labels(nearly)
        instant, paths = np.minimum(earliest[a], earliest[b]), self.paths
        at = chosen.between(paths.position(chosen.row_a, instant), paths.position(chosen.row_b, instant))
        return nearly[at.gap <= touching(chosen, paths.origin)]

    def _split(self, first: IntArray, ties: IntArray) -> tuple[IntArray, IntArray]:
        """Of the earliest contacts those that act alone, and the blocks: what shares a body, ties, and what touches."""
        a, b = self._labels(first)
        # A contact that finds another's number on a body of its own shares that body.
        number, owner = np.arange(len(first)), np.empty(len(self.rows), np.intp)
        owner[a] = number
        owner[b] = number
        clash = (owner[a] != number) | ((owner[b] != number) & self.moves[b])
        if len(ties) == 0 and len(self.touch) == 0 and not clash.any():
            return first, ties
        joint, hot = np.zeros(len(self.rows), bool), np.zeros(len(self.rows), bool)
        for of_a, of_b in ((a[clash], b[clash]), self._labels(ties), self._labels(self.touch)):
            joint[of_a] = joint[of_b] = True
        joint[~self.moves] = False
        together = joint[a] | joint[b]
        hot[a[together]] = hot[b[together]] = True
        tie_a, tie_b = self._labels(ties)
        hot[~self.moves] = False
        joining = hot[tie_a] | hot[tie_b]
        hot[tie_a[joining]] = hot[tie_b[joining]] = True
        touch = self.touch[hot[self._labels(self.touch)[0]]]
        return first[~together], np.unique(np.concatenate((first[together], ties[joining], touch)))

    def _labels(self, contacts: IntArray) -> tuple[IntArray, IntArray]:
        return self.label[self.pairs.row_a[contacts]], self.label[self.pairs.row_b[contacts]]
