"""What joints will do next, from what they did: exact for what it is made for; and steps that it makes cheaper."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.joints.foresight import DEPTH, SUZUKI_PARTS, WEIGHTS
from eeca_pymunk.joints.ladder import SUZUKI
from scenes import linkages

from .driving import Driven, error

LENGTHS = (SUZUKI, SUZUKI, 1.0 - 4.0 * SUZUKI, SUZUKI, SUZUKI)


def functions(parts: int) -> FloatArray:
    """(6, parts) what accelerations are made of: smooth in time, of the length of a part, rates that ring or settle."""
    s = np.resize(LENGTHS, parts)
    t = np.cumsum(s) - 0.5 * s
    ringing, rate = np.empty(parts), 0.3
    for k in range(parts):
        after = 0.5 * s[k] ** 2 - rate
        ringing[k], rate = (after - rate) / s[k], after
    return np.stack((np.ones(parts), t, t * t, s * s, (-1.0) ** np.arange(parts) / s, ringing))


def test_weights_foretell_what_they_are_made_for() -> None:
    values = functions(30)
    for k in range(DEPTH, 30):
        foretold = values[:, k - DEPTH : k][:, ::-1] @ WEIGHTS[k % SUZUKI_PARTS]
        np.testing.assert_allclose(foretold, values[:, k], rtol=0.0, atol=1e-12 * np.abs(values).max())


@pytest.mark.parametrize("longer", [1e-6, 0.5])
def test_a_step_of_another_length_begins_anew(longer: float) -> None:
    """Nothing is foretold over a change of dt, or after an edit; joints hold all the same."""
    space = linkages.chain(4, lean=0.5)
    stepper = Driven(space)
    dt = 1.0 / 240.0
    counts = []
    for k in range(12):
        stepper.step(dt * (1.0 + (longer if k == 6 else 0.0)))
        counts.append(stepper.joints.JOINT[0].known_parts)
        assert error(space) < 1e-13
    assert counts[0] == SUZUKI_PARTS
    assert min(counts[1:6]) >= DEPTH
    assert counts[6:8] == [SUZUKI_PARTS, SUZUKI_PARTS]
    first = next(iter(space.bodies))
    first.velocity = first.velocity * 1.0001
    stepper.step(dt)
    assert stepper.joints.JOINT[0].known_parts == 5.0
