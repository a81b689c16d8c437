"""The example of an environment: gymnasium's own checks, save and restore, copies on threads."""

from __future__ import annotations

import importlib.util
import warnings
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env


@pytest.fixture(scope="module")
def balance() -> ModuleType:
    path = Path(__file__).parents[1] / "docs" / "examples" / "balance.py"
    spec = importlib.util.spec_from_file_location("balance", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_gymnasium_finds_nothing_wrong(balance: ModuleType) -> None:
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*infinity.*")  # observations have no bounds
        warnings.filterwarnings("ignore", message=".*spec of the environment.*")  # it is not registered
        warnings.filterwarnings("ignore", message=".*render modes.*")
        check_env(balance.Balance(), skip_render_check=True)


def test_restored_the_same_actions_give_the_same_observations(balance: ModuleType) -> None:
    env = balance.Balance()
    env.reset(seed=3)
    actions = np.random.default_rng(0).uniform(-0.3, 0.3, (40, 1)).astype(np.float32)
    for action in actions[:10]:
        env.step(action)
    saved = env.save()
    paths = []
    for _ in range(2):
        env.restore(saved)
        paths.append([env.step(action) for action in actions[10:]])
        env.reset(seed=9)
    for one, other in zip(*paths, strict=True):
        np.testing.assert_array_equal(one[0], other[0])
        assert one[1:] == other[1:]


def test_resets_repeat_whatever_came_before(balance: ModuleType) -> None:
    env = balance.Balance()
    found = []
    for steps in (0, 7, 31):
        env.reset(seed=1)
        for _ in range(steps):
            env.step(np.ones(1, np.float32))
        env.reset(seed=5)
        found.append([env.step(np.full(1, 0.1, np.float32))[0] for _ in range(20)])
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])


def test_copies_are_the_environment(balance: ModuleType) -> None:
    copies, one = balance.Balances(3, threads=2), balance.Balance()
    many, _ = copies.reset(seed=2)
    one.reset(seed=0)
    one.stepper.set_state(copies.states[1].copy())
    for k in range(30):
        actions = np.full((3, 1), 0.2 * (-1) ** k, np.float32)
        many, rewards, terminated, truncated, _ = copies.step(actions)
        seen, *_ = one.step(actions[1])
        # A rollout fits velocities to the joints where it begins, and an upright pole makes ten of each difference.
        np.testing.assert_allclose(many[1], seen, rtol=0.0, atol=1e-4)
        assert many.shape == (3, 4)
        assert rewards.tolist() == [1.0] * 3
        assert not terminated.any()
        assert not truncated.any()


def test_copies_that_have_ended_begin_anew(balance: ModuleType) -> None:
    copies = balance.Balances(2)
    copies.reset(seed=2)
    copies.states[0] = balance.states_at(np.array([[0.0, 0.3, 0.0, 0.0]]))[0]
    still = np.zeros((2, 1), np.float32)
    _, _, terminated, _, _ = copies.step(still)
    assert terminated.tolist() == [True, False]
    seen, rewards, terminated, _, _ = copies.step(still)
    assert rewards.tolist() == [0.0, 1.0]
    assert abs(seen[0, 1]) <= 0.05
    assert not terminated.any()


def test_a_controller_keeps_poles_up(balance: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    balance.main()
    told = capsys.readouterr().out
    assert "one pole: 500 of 500 steps" in told
    assert "256 poles: 0 fell in 500 steps" in told
