"""What rounds remember: the beginning of a window of the step, and from one step to the next."""

from __future__ import annotations

from dataclasses import dataclass

from .bodies import FloatArray, IntArray
from .contacts import Pairs
from .paths import Paths
from .touching import Resting


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
    """What a step knows about the next: when its pairs meet, counted from the end, if the bodies go on as they are."""

    pairs: Pairs
    time: FloatArray
    gap: FloatArray
    touch: IntArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    pulled: bool
