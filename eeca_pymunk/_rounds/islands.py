"""Islands of bodies that hang together by contacts, and the energy lock of last resort: scaling their velocities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray

_MOST = 2.0  # times its energy that the lock may give an island


@dataclass(frozen=True)
class Island:
    """The islands of R bodies `rows` (R,) and m contacts; islands are numbered by the label of a body.

    Attributes:
        label: (R,) island of each body.  of: (m,) island of each contact.  moves: (R,) bool.
        free: (R,) by island, whether it touches nothing that stays.  lossy: (R,) whether one of its contacts is.
    """

    rows: IntArray
    label: IntArray
    of: IntArray
    moves: BoolArray
    free: BoolArray
    lossy: BoolArray

    @staticmethod
    def of_bodies(
        rows: IntArray, a: IntArray, b: IntArray, moves: BoolArray, lossy: BoolArray, label: IntArray
    ) -> Island:
        """The islands by `label` (R,), of contacts between bodies a and b (m,) that are `lossy` (m,)."""
        of = np.where(moves[a], label[a], label[b])
        free, any_lossy = np.ones(len(rows), bool), np.zeros(len(rows), bool)
        free[of[~(moves[a] & moves[b])]] = False
        any_lossy[of[lossy]] = True
        return Island(rows, label, of, moves, free, any_lossy)

    def sum(self, values: FloatArray | BoolArray) -> FloatArray:
        """(R,) sum of (m,) values of contacts by island."""
        total: FloatArray = np.zeros(len(self.label))
        np.add.at(total, self.of, values)
        return total

    def given(self, energy: FloatArray) -> FloatArray:
        """(R,) what of an energy (R,) by island has to be taken back: who dissipates may keep a loss."""
        return np.where(self.lossy, np.maximum(energy, 0.0), energy)

    def kinetic(self, v: FloatArray, mobility: FloatArray) -> FloatArray:
        """(R,) kinetic energy by island, bodies of mobility (R, d or 1) at velocities (R, d)."""
        weight = np.divide(1.0, mobility, out=np.zeros_like(mobility), where=mobility > 0.0)
        total: FloatArray = np.zeros(len(self.label))
        np.add.at(total, self.label, 0.5 * (weight * v * v).sum(axis=1) * self.moves)
        return total

    def without(self, v: FloatArray, loss: FloatArray, mass: FloatArray, mobility: FloatArray) -> FloatArray:
        """(R, d) velocities with the energy (R,) of each island less by `loss`, as far as there is some.

        They are scaled by one factor for each island, of a free one about its common motion, which keeps its momentum.
        `mass` (N,), `mobility` (N, d or 1) of all bodies.
        """
        scaled = np.flatnonzero(self.moves & (loss[self.label] != 0.0))
        if len(scaled) == 0:
            return v
        of, rows, count = self.label[scaled], self.rows[scaled], len(self.label)
        total = np.bincount(of, mass[rows], count)
        own = v[scaled].copy()
        for axis in (0, 1):
            common = np.divide(
                np.bincount(of, mass[rows] * own[:, axis], count), total, out=np.zeros(count), where=total > 0
            )
            own[:, axis] -= np.where(self.free[of], common[of], 0.0)
        weight = np.divide(1.0, mobility[rows], out=np.zeros_like(mobility[rows]), where=mobility[rows] > 0.0)
        kinetic = np.bincount(of, 0.5 * (weight * own * own).sum(axis=1), count)
        left = np.divide(kinetic - loss, kinetic, out=np.ones(count), where=kinetic > 0.0)
        result = v.copy()
        result[scaled] += (np.sqrt(np.clip(left, 0.0, _MOST))[of] - 1.0)[:, None] * own
        return result
