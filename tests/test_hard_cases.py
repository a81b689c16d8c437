"""Every hard case holds for the default EECA; and a broken kernel makes one fail."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import eeca_pymunk as ep
from comparisons import hard_cases
from comparisons.hard_cases import CASES, Case
from comparisons.output import Output
from eeca_pymunk._rounds import blocks, impact_times, impacts
from eeca_pymunk._rounds.contacts import Pairs
from eeca_pymunk.energy import balance

BY_NAME = {one.name: one for one in CASES}


def default(one: Case, max_rounds: int = 100_000) -> float:
    found = hard_cases.figure(one, lambda space: ep.EECA(space, ep.TimeOfImpact(max_rounds)))
    assert found is not None
    return found


@pytest.mark.parametrize("one", CASES, ids=lambda one: one.name)
def test_case_holds_for_the_default_stepper(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in hard_cases.LONG:
        monkeypatch.setitem(hard_cases.LONG, name, 2000)
    assert default(one) <= one.limit


def test_matrix_tells_passes_failures_and_refusals(
    tmp_path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    some = [BY_NAME[name] for name in ("swap of velocities", "touching line of three", "rod onto its corner")]
    monkeypatch.setattr(hard_cases, "CASES", some)
    hard_cases.run(Output("hard_cases", tmp_path), False)
    printed = capsys.readouterr().out
    assert "passed of 3: TimeOfImpact 3, Midstep 2, Dashpot 1, native 10 2, native 100 2" in printed
    assert "refused" in printed
    assert (tmp_path / "hard_cases.png").exists()
    assert (tmp_path / "hard_cases.csv").exists()


def flipped_impulse(patch: pytest.MonkeyPatch) -> None:
    """An impulse with the sign of its loss flipped: (1 - e) for (1 + e)."""
    patch.setattr(Pairs, "elasticity", property(lambda self: -np.ones(len(self))))


def late_impacts(patch: pytest.MonkeyPatch) -> None:
    """Times of impact a thousandth too late."""
    kernel = impact_times.disk_disk
    patch.setattr(
        impact_times, "disk_disk", lambda d, u, extent: (kernel(d, u, extent)[0] * 1.001, kernel(d, u, extent)[1])
    )


def normal_of_the_start(patch: pytest.MonkeyPatch) -> None:
    """Normals where the step began instead of at the impact."""
    meet = impacts.Impacts.meet

    def early(self: impacts.Impacts, pairs: Pairs, time: np.ndarray) -> impacts.Meeting:
        return meet(self, pairs, 0.0 * time)

    patch.setattr(impacts.Impacts, "meet", early)


def no_restitution_of_blocks(patch: pytest.MonkeyPatch) -> None:
    """Simultaneous impacts that stop instead of reflecting."""
    patch.setattr(balance, "restitution_target", lambda relative, elasticity: 0.0 * relative)


def arms_left_out(patch: pytest.MonkeyPatch) -> None:
    """Impulses that act at the centres of mass."""
    directions = Pairs.directions

    def without(self: Pairs, at, pose_a, pose_b):
        found = tuple(np.array(J) for J in directions(self, at, pose_a, pose_b))
        for J in found:
            J[:, 2:] = 0.0
        return found

    patch.setattr(Pairs, "directions", without)


def one_corner_of_a_face(patch: pytest.MonkeyPatch) -> None:
    """Faces that meet at one point only."""
    patch.setattr(Pairs, "faces", lambda self, at, a, b: (np.zeros(0, np.intp), at.take(np.zeros(0, np.intp))))


def no_rest(patch: pytest.MonkeyPatch) -> None:
    """Contacts that touch and have no force."""
    patch.setattr(blocks.Blocks, "_rest", lambda self, *arguments: None)


@pytest.mark.parametrize(
    ("break_it", "name"),
    [
        (flipped_impulse, "swap of velocities"),
        (late_impacts, "dt from 3e-5 to 1/10"),
        (normal_of_the_start, "units from 1e-3 to 1e4 m"),
        (no_restitution_of_blocks, "touching line of three"),
        (arms_left_out, "rod onto its corner"),
        (one_corner_of_a_face, "stack of five boxes"),
        (no_rest, "resting ball, elastic"),
    ],
)
def test_a_broken_kernel_fails_a_case(
    break_it: Callable[[pytest.MonkeyPatch], None], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert break_it.__doc__
    break_it(monkeypatch)
    # Impulses that are wrong may have to be repeated forever.
    assert not default(BY_NAME[name], max_rounds=20) <= BY_NAME[name].limit


def test_a_disabled_lock_fails_a_crowded_case(monkeypatch: pytest.MonkeyPatch) -> None:
    import scenes

    def drift() -> float:
        scene = scenes.build("hopper", columns=9, layers=9)
        stepper = ep.EECA(scene.space, ep.Midstep(tolerance=1e-2), sync=False)
        start = ep.measure(scene.space).energy
        for _ in range(130):
            stepper.step(scene.dt)
        return abs(ep.measure(scene.space).energy / start - 1.0)

    assert drift() <= 1e-12
    lock = balance.energy_lock

    def unlocked(*arguments, **named) -> balance.Lock:
        found = lock(*arguments, **named)
        return balance.Lock(np.ones_like(found.scale), found.valid)

    monkeypatch.setattr(balance, "energy_lock", unlocked)
    assert drift() > 1e-9
