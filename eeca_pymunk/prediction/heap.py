"""The heap of events: the earliest on top, ties by the number of the body. Entries are not removed when a prediction
changes: one is valid while its time equals `Body.due`.

TIME and OF are the instants and the bodies of its n entries. Each function returns the number of entries afterwards.
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.bodies import Body


@nonallocating
def push_event(TIME: FloatArray, OF: IntArray, n: int, time: float, body: int) -> int:
    """Add an event of a body at an instant `time` to a heap of n."""
    k = n
    while k > 0:
        up = (k - 1) >> 1
        if TIME[up] < time or (TIME[up] == time and OF[up] <= body):
            break
        TIME[k], OF[k] = TIME[up], OF[up]
        k = up
    TIME[k], OF[k] = time, body
    return n + 1


@nonallocating
def pop(TIME: FloatArray, OF: IntArray, n: int) -> int:
    """Remove the first event of a heap of n."""
    n -= 1
    # The hole sinks to a leaf without unpredictable branches; the last entry, which fills it, usually belongs near a
    # leaf.
    k = 0
    while 2 * k + 2 < n:
        down = 2 * k + 1
        left, right = TIME[down], TIME[down + 1]
        second = right < left
        if left == right:
            second = OF[down + 1] < OF[down]
        down += 1 if second else 0
        TIME[k], OF[k] = TIME[down], OF[down]
        k = down
    if 2 * k + 1 < n:
        TIME[k], OF[k] = TIME[2 * k + 1], OF[2 * k + 1]
        k = 2 * k + 1
    push_event(TIME, OF, k, TIME[n], OF[n])
    return n


@nonallocating
def sweep_out(TIME: FloatArray, OF: IntArray, n: int, BODY: Rows[Body]) -> int:
    """Remove invalid entries from a heap of n, and all but one of equal ones."""
    size, first = n, n
    while n > 0:
        time, body = TIME[0], OF[0]
        n = pop(TIME, OF, n)
        alike = first < size and time == TIME[first] and body == OF[first]
        if time == BODY[body].due and not alike:
            first -= 1
            TIME[first], OF[first] = time, body
    # The valid entries, with the latest first, are the last ones of the arrays; in the order of time they are a heap.
    kept = size - first
    for k in range(kept // 2):
        a, b = first + k, size - 1 - k
        TIME[a], TIME[b] = TIME[b], TIME[a]
        OF[a], OF[b] = OF[b], OF[a]
    for k in range(kept):
        TIME[k], OF[k] = TIME[first + k], OF[first + k]
    return kept
