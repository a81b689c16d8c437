"""The plan of joints: who hangs together, and the order of unknowns."""

from __future__ import annotations

import numpy as np
import pymunk

from eeca_pymunk.model.joints import CONDENSED, STEPS
from scenes import linkages
from scenes.linkages import body, empty

from .driving import Driven


def test_components_are_those_of_the_graph() -> None:
    rng = np.random.default_rng(1)
    space = empty()
    bodies = [body(space, 1.0, 1.0, (float(i), 0.0)) for i in range(60)]
    for _ in range(45):
        i, j = rng.choice(60, 2, replace=False)
        other = space.static_body if rng.random() < 0.2 else bodies[j]
        space.add(pymunk.DampedSpring(bodies[i], other, (0, 0), (0, 0), 1.0, 1.0, 0.0))
    J = Driven(space).joints
    label = {b: i for i, b in enumerate(bodies)}
    for _ in range(60):
        for c in space.constraints:
            if c.b is not space.static_body:
                label[c.a] = label[c.b] = min(label[c.a], label[c.b])
    bound = {c.a for c in space.constraints} | {c.b for c in space.constraints} - {space.static_body}
    assert J.TALLY.components == len({label[b] for b in bound if b is not space.static_body})
    items, seen = [*bodies, space.static_body], list[int]()
    for C in J.COMPONENT[: J.TALLY.components]:
        own = [items[min(J.JOINED[i].body, len(bodies))] for i in range(C.first_body, C.end_body)]
        assert len({label[b] for b in own if b is not space.static_body}) == 1
        seen += J.COUPLING["joint"][C.first_joint : C.end_joint].tolist()
    assert sorted(seen) == list(range(45))


def test_bands_are_as_narrow_as_their_graphs() -> None:
    spans = {}
    for name, make in (("chain", lambda: linkages.chain(30)), ("cloth", lambda: linkages.cloth(12))):
        spans[name] = Driven(make()).joints.COMPONENT[0]
    chain, cloth = spans["chain"], spans["cloth"]
    assert (chain.unknowns, chain.band, chain.dual_for) == (150, 4, STEPS)
    assert (chain.dual_size, chain.dual_band) == (60, 3)
    assert cloth.system == CONDENSED
    assert cloth.unknowns == 288
    assert cloth.band <= 2 * 13
