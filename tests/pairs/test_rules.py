"""Rules of pairs: found as a dictionary finds them, in either order of the two shapes."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.compiled.records import put, rows
from eeca_pymunk.model.shapes import Shape
from eeca_pymunk.pairs.rules import barred, law
from eeca_pymunk.space.decisions import Rules
from tests.packed import scene_with


@pytest.mark.parametrize("count", [0, 1, 2, 7, 40])
def test_rules_are_found_as_in_a_dictionary(count: int) -> None:
    random, shapes = np.random.default_rng(count), 12
    SHAPE = rows(Shape, shapes)
    put(SHAPE, random.random((shapes, len(Shape.TYPE))), *(Shape.TYPE.names or ()))
    every = [(a, b) for a in range(shapes) for b in range(a + 1, shapes)]
    chosen = [every[i] for i in random.permutation(len(every))[:count]]
    ignored, rest = chosen[: count // 3], chosen[count // 3 :]
    rules = Rules(frozenset(ignored), {pair: tuple(random.random(4)) for pair in rest})
    parted = set(chosen[count // 3 : count // 2])
    told = rules.of_pairs(SHAPE, parted)
    RULE = np.array([(*pair, *what) for pair, what in told.items()], float).reshape(-1, 6)
    scene = scene_with(SHAPE=SHAPE, RULE=RULE)
    for a, b in every:
        assert barred(scene, a, b) == barred(scene, b, a) == ((a, b) in parted.union(ignored))
        e, mu, sx, sy = law(scene, a, b)
        assert law(scene, b, a) == (e, mu, -sx, -sy)
        if (a, b) not in told:
            assert (e, mu) == (
                SHAPE["elasticity"][a] * SHAPE["elasticity"][b],
                SHAPE["friction"][a] * SHAPE["friction"][b],
            )
            assert (sx, sy) == (SHAPE[b].surface_x - SHAPE[a].surface_x, SHAPE[b].surface_y - SHAPE[a].surface_y)
        elif (a, b) not in parted.union(ignored):
            assert (e, mu, sx, sy) == rules.changed[a, b]
