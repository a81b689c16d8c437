"""The energy of impacts on jointed bodies, whose response to impulses is known with an error."""

from __future__ import annotations

import numpy as np
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import zeros
from eeca_pymunk.impacts.joint_impact import settle_energy
from eeca_pymunk.impacts.simultaneous import Block
from eeca_pymunk.model.contacts import SOLVED, Row
from scenes import build


@pytest.mark.parametrize("error", [-1e-3, 0.0, 1e-3])
@pytest.mark.parametrize("elastic", [False, True])
def test_an_error_of_the_response_is_no_work_from_outside(error: float, elastic: bool) -> None:
    """A body of mass 2 hits a wall at speed 3; joints are to answer by (1 + error) of the velocity."""
    scene = ep.EECA(build("gas", count=2).space).event_loop.scene
    rows, out = zeros(1, Row.TYPE), zeros(1, SOLVED)
    rows[0].nx = rows[0].elasticity = 1.0
    impulse = 2.0 * 3.0 * (2.0 if elastic else 1.0)
    before = np.array([[0.0, 0.0, 0.0], [-3.0, 0.0, 0.0]])[::-1].copy()
    after = before.copy()
    after[0, 0] += (1.0 + error) * impulse / 2.0
    mobility, ends = np.array([0.5, 0.0]), (np.array([1]), np.array([0]))
    block = Block(before, after, mobility, np.zeros(2), *ends, rows, np.zeros((1, 2)), np.zeros(1, np.int64))
    impulses = np.array([[impulse, 0.0]])
    settle_energy(scene, block, 1, impulses, before, before, False, 0.0, elastic, out)
    left = 0.5 * 2.0 * after[0, 0] ** 2
    assert scene.PAR.external == 0.0
    assert out[0].restitution == pytest.approx(9.0 - left, abs=1e-12)
    assert out[0].restitution == pytest.approx(0.0, abs=1e-12) if elastic else out[0].restitution > 8.9
    assert impulses[0, 0] / impulse == pytest.approx((after[0, 0] + 3.0) / (1.0 + error) / impulse * 2.0, rel=1e-12)
