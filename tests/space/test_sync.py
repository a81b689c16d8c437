"""pymunk's own shapes are where a step has put the bodies, by either way of syncing."""

from __future__ import annotations

import pymunk
import pytest

from eeca_pymunk.space import sync
from scenes.scene import add_disk

from ..test_packed_stepper import FreeFlight

DT = 0.0625


def crowd(count: int, hashed: bool = False) -> pymunk.Space:
    """Disks of radius .4 on a grid, all at velocity (2, 1), in a column of gravity."""
    space = pymunk.Space()
    if hashed:
        space.use_spatial_hash(1.0, 100)
    space.gravity = (0.0, -1.0)
    for i in range(count):
        add_disk(space, (i % 10, i // 10), 0.4, velocity=(2.0, 1.0))
    return space


def counted(stepper: FreeFlight, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The ways taken from now on."""
    ways: list[str] = []
    rest, reindex = sync.rest_step, sync.Sync.reindex
    monkeypatch.setattr(sync, "rest_step", lambda *how, **more: (ways.append("rest"), rest(*how, **more))[1])
    monkeypatch.setattr(sync.Sync, "reindex", lambda self: (ways.append("reindex"), reindex(self))[1])
    return ways


@pytest.mark.parametrize("hashed", [False, True])
@pytest.mark.parametrize("count", [1, sync.FEW, sync.FEW + 1, 40])
def test_queries_find_the_bodies_where_they_are(count: int, hashed: bool) -> None:
    space = crowd(count, hashed)
    stepper = FreeFlight(space)
    for _ in range(50):
        stepper.step(DT)
        for body in space.bodies:
            found = space.point_query_nearest(body.position, 0.0, pymunk.ShapeFilter())
            assert found is not None
            assert found.shape is not None
            assert found.shape.body is body
            assert found.shape.bb.left == pytest.approx(body.position.x - 0.4)
    assert space.current_time_step == DT
    assert space.gravity == (0.0, -1.0)
    assert space.iterations == pymunk.Space().iterations


def test_few_shapes_are_reindexed_and_the_broad_phase_renewed_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    stepper = FreeFlight(crowd(3))
    ways = counted(stepper, monkeypatch)
    for _ in range(70):
        stepper.step(DT)
    assert ways == (["rest"] + 32 * ["reindex"]) * 2 + ["rest"] + 3 * ["reindex"]
    stepper = FreeFlight(crowd(sync.FEW + 1))
    ways.clear()
    stepper.step(DT)
    stepper.step(DT)
    assert ways == ["rest", "rest"]


def test_what_only_a_step_of_pymunk_does_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    space = crowd(1)
    stepper = FreeFlight(space)
    ways = counted(stepper, monkeypatch)
    stepper.step(DT)
    stepper.step(DT)
    stepper.step(0.5 * DT)  # another dt is one to note
    assert space.current_time_step == 0.5 * DT
    stepper.step(0.5 * DT)
    space.step(0.5 * DT)  # old contacts of native steps are to be forgotten
    stepper.step(0.5 * DT)
    stepper.step(0.5 * DT)
    called: list[str] = []
    space.add_post_step_callback(lambda space, key: called.append(key), "key")
    stepper.step(0.5 * DT)
    assert called == ["key"]
    assert ways == ["rest", "reindex", "rest", "reindex", "rest", "reindex", "reindex"]


@pytest.mark.parametrize("count", [1, 30])
def test_a_callback_may_add_and_remove_bodies(count: int) -> None:
    space = crowd(count)
    stepper = FreeFlight(space)
    stepper.step(DT)
    first, last = next(iter(space.bodies)), list(space.bodies)[-1]
    expected = last.velocity.y - DT

    def change(space: pymunk.Space, key: str) -> None:
        space.remove(first, *first.shapes)
        add_disk(space, (0.0, 50.0), 0.4)

    space.add_post_step_callback(change, "change")
    stepper.step(DT)
    assert first not in space.bodies
    if count > 1:
        assert last.velocity == (2.0, expected)
    stepper.step(DT)
    assert list(space.bodies)[-1].velocity == (0.0, -DT)


def test_without_sync_pymunks_shapes_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    space = crowd(1)
    stepper = FreeFlight(space, sync=False)
    ways = counted(stepper, monkeypatch)
    before = [s.bb for s in space.shapes]
    stepper.step(DT)
    assert [s.bb for s in space.shapes] == before
    assert ways == []
