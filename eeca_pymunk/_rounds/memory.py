"""What rounds remember: the beginning of a window of the step, and from one step to the next."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from ..arrays import FloatArray, IntArray
from .contacts import Pairs
from .paths import Paths
from .touching import Resting

Number = TypeVar("Number", np.float64, np.intp)


@dataclass(frozen=True)
class Saved:
    """What a window of the step began with."""

    paths: Paths
    before: Paths
    pairs: Pairs
    time: FloatArray
    bounces: IntArray
    touch: IntArray
    resting: Resting
    lock: float
    log: int


@dataclass(frozen=True)
class Memory:
    """What a step knows about the next: when its pairs meet, counted from the end, if the bodies go on as they are, and
    the part of a step within which the order of impacts is likely to be found at once."""

    pairs: Pairs
    time: FloatArray
    gap: FloatArray
    touch: IntArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    window: float

    def about(self, pairs: Pairs) -> Memory:
        """What is known of another list of pairs: of those that are new nothing, their instants are NaN."""
        if pairs is self.pairs:
            return replace(self, time=self.time.copy(), gap=self.gap.copy())
        place = self.pairs.places_in(pairs)
        time, gap = carried(self.time, place, len(pairs), np.nan), carried(self.gap, place, len(pairs), np.inf)
        touch = place[self.touch]
        return replace(self, pairs=pairs, time=time, gap=gap, touch=touch[touch >= 0])


def carried(values: npt.NDArray[Number], place: IntArray, count: int, new: float) -> npt.NDArray[Number]:
    """(count,) `values` at the places (m,) where these are not negative, `new` elsewhere."""
    result = np.full(count, new, values.dtype)
    kept = place >= 0
    result[place[kept]] = values[kept]
    return result
