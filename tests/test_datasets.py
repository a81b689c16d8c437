"""Rollouts in files, and how far off they may be."""

from __future__ import annotations

import json
import threading
from contextlib import suppress
from dataclasses import fields
from pathlib import Path

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from comparisons.exact import Gas
from eeca_pymunk.files import check_writable, whole_file
from tests.test_rollouts import gas
from tests.test_states import poses


def made() -> tuple[ep.EECA, ep.Rollouts]:
    stepper, _ = gas()
    states = poses(stepper.space)[None].repeat(8, axis=0)
    states[:, :, 3:5] = np.random.default_rng(7).normal(size=(8, 5, 2))
    return stepper, ep.rollout(stepper, states, 120, 1 / 60, every=2, full=True)


@pytest.mark.parametrize("suffix", ["npz", "h5"])
def test_files_give_back_what_was_saved(tmp_path: Path, suffix: str) -> None:
    if suffix == "h5":
        pytest.importorskip("h5py")
    _, rollouts = made()
    rollouts.parameters["seed"] = 7
    rollouts.save(tmp_path / f"films.{suffix}")
    again = ep.Rollouts.load(tmp_path / f"films.{suffix}")
    for f in fields(ep.Rollouts):
        if f.name not in ("events", "parameters"):
            np.testing.assert_array_equal(getattr(again, f.name), getattr(rollouts, f.name))
    for f in fields(ep.Events):
        np.testing.assert_array_equal(getattr(again.events, f.name), getattr(rollouts.events, f.name))
    assert again.parameters == rollouts.parameters
    assert {"steps", "dt", "every", "pymunk", "eeca-pymunk", "numpy", "model", "seed"} <= set(again.parameters)
    assert len(again) == 8


def test_a_file_whose_content_was_changed_is_refused(tmp_path: Path) -> None:
    made()[1].save(tmp_path / "films.npz")
    with np.load(tmp_path / "films.npz") as data:
        found = dict(data)
    found["frames"][3, 4, 0, 0] += 1e-12
    np.savez(tmp_path / "films.npz", **found)
    with pytest.raises(ValueError, match="hash"):
        ep.Rollouts.load(tmp_path / "films.npz")
    del found["ledger"]
    np.savez(tmp_path / "films.npz", **found)
    with pytest.raises(ValueError, match=r"is not a file that Rollouts\.save wrote"):
        ep.Rollouts.load(tmp_path / "films.npz")


def test_each_writer_of_a_file_has_its_own_temporary_file(tmp_path: Path) -> None:
    """Two at once: the second begins while the first is not done, and ends before it."""
    path = tmp_path / "same.npz"
    with whole_file(path) as first:
        first.write_text("first")
        with whole_file(path) as second:
            assert second != first
            second.write_text("second")
        assert path.read_text() == "second"
        assert first.read_text() == "first"
    assert path.read_text() == "first"
    with pytest.raises(FileNotFoundError), whole_file(path):
        (tmp_path / "none").read_text()
    assert [one.name for one in tmp_path.iterdir()] == ["same.npz"]
    with pytest.raises(OSError, match="too long"):
        check_writable(tmp_path / ("a" * 300 + ".npz"))


def test_writers_of_one_file_leave_a_whole_one(tmp_path: Path) -> None:
    rollouts = [made()[1], made()[1]]
    rollouts[1].frames = rollouts[1].frames[:, :7].copy()
    path = tmp_path / "same.npz"
    for _ in range(5):
        threads = [threading.Thread(target=one.save, args=(path,)) for one in rollouts]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert ep.Rollouts.load(path).frames.shape[1] in (7, 60)
    assert [one.name for one in tmp_path.iterdir()] == ["same.npz"]


@pytest.mark.parametrize("suffix", ["npz", "h5"])
def test_damaged_files_are_refused(tmp_path: Path, suffix: str) -> None:
    if suffix == "h5":
        pytest.importorskip("h5py")
    path = tmp_path / f"films.{suffix}"
    rollouts = made()[1]
    rollouts.save(path)
    whole = path.read_bytes()
    # The first name of zip's last part, with the version, flag and compression that it needs; bytes from everywhere.
    last = whole.find(b"PK\x01\x02")
    places = {*range(last, last + 60 if last > 0 else last), *range(0, len(whole), max(len(whole) // 300, 1))}
    for place in sorted(places):
        for change in (1, 0xFF):
            damaged = bytearray(whole)
            damaged[place] ^= change
            path.write_bytes(damaged)
            with suppress(ValueError):
                np.testing.assert_array_equal(ep.Rollouts.load(path).frames, rollouts.frames)
    for text in (b"", whole[:100], whole[:-100]):
        path.write_bytes(text)
        with pytest.raises(ValueError, match=r"is not a file that Rollouts\.save wrote"):
            ep.Rollouts.load(path)
    with pytest.raises(FileNotFoundError):
        ep.Rollouts.load(tmp_path / f"none.{suffix}")


def test_parameters_that_users_add(tmp_path: Path) -> None:
    rollouts, path = made()[1], tmp_path / "films.npz"
    rollouts.parameters |= {"seed": np.int64(3), "mass": np.float32(0.5), "warm": np.bool_(True), "nested": {"a": [1]}}
    rollouts.save(path)
    found = ep.Rollouts.load(path).parameters
    assert (found["seed"], found["mass"], found["warm"], found["nested"]) == (3, 0.5, True, {"a": [1]})
    before = path.read_bytes()
    for bad in (np.arange(3), {1, 2}, {"of": pymunk.Space}, np.complex128(1j), np.longdouble(1.0)):
        rollouts.parameters["units"] = bad
        with pytest.raises(TypeError, match=r"parameters\['units'\] is .*: give numbers"):
            rollouts.save(path)
        assert path.read_bytes() == before


def test_two_files_of_the_same_films_have_the_same_hash(tmp_path: Path) -> None:
    hashes = []
    for name in ("one.npz", "two.npz"):
        made()[1].save(tmp_path / name)
        with np.load(tmp_path / name) as data:
            hashes.append(str(data["sha256"]))
            json.loads(str(data["parameters"]))
    assert hashes[0] == hashes[1]


def test_the_certificate_of_a_gas_holds_against_events_in_time_order() -> None:
    """Impacts of disks are exact: the error is round-off that each impact multiplies, and the certificate tells it."""
    stepper, rollouts = made()
    assert np.isnan(rollouts.error).all()
    error = ep.certify(stepper, rollouts)
    assert error is rollouts.error
    assert (error < 1e-8).all()
    for k, state in enumerate(rollouts.states):
        exact = Gas(0.5 * (state[:, :2] + 1.0), 0.5 * state[:, 3:5], np.full(5, 0.075), np.ones(5))
        worst = 0.0
        for frame in rollouts.frames[k]:
            exact.run(2 / 60)
            worst = max(worst, float(np.linalg.norm(2.0 * exact.position - 1.0 - frame[:, :2], axis=1).max()))
        # Another code rounds otherwise: of the same order.
        assert worst < 100.0 * max(error[k], 1e-15)


def test_the_certificate_of_a_pendulum_is_its_error() -> None:
    """Fourth order in dt: half the step leaves a sixteenth of the error, so that twice the difference bounds it."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    bob = pymunk.Body(1.0, 1.0)
    bob.position = (1.0, 0.0)
    space.add(bob, pymunk.PinJoint(space.static_body, bob, (0.0, 0.0), (0.0, 0.0)))
    stepper = ep.EECA(space)
    start = poses(space)[None]
    rollouts = ep.rollout(stepper, start, 60, 1 / 30, full=True)
    error = float(ep.certify(stepper, rollouts)[0])
    fine = ep.rollout(stepper, start, 60 * 32, 1 / 960, every=32)
    true = float(np.linalg.norm(fine[..., :2] - rollouts.frames[..., :2], axis=-1).max())
    assert 1e-9 < true < error < 4.0 * true


def test_the_ledger_of_a_film() -> None:
    _, rollouts = made()
    ledger = rollouts.ledger_of(3)
    assert abs(ledger.change) < 1e-13
    assert ledger.restitution == 0.0
