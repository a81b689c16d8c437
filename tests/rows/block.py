"""Blocks of disks and boxes for tests: rows straight from geometry, without pymunk."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.model.contacts import Problem, Row, Solved
from eeca_pymunk.rows.blocks import solve_block
from eeca_pymunk.rows.build import place_row
from eeca_pymunk.rows.energy import losses_of

Floats = npt.NDArray[np.float64]


@dataclass
class Block:
    """Bodies (position, velocity, 1/mass, 1/moment), the ground last, and contacts given by points and normals."""

    pose: Floats
    velocity: Floats
    im: Floats
    ii: Floats
    contacts: list[tuple[int, int, float, float, float, float]] = field(default_factory=list)  # a, b, n, point

    @classmethod
    def disks(cls, position: Floats, velocity: Floats, mass: Floats, radius: Floats, touch: float = 1e-9) -> Block:
        """Disks; all pairs with a gap below `touch` are contacts."""
        n = len(position)
        pose, v = np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
        pose[:n, :2], v[:n, : velocity.shape[1]] = position, velocity
        im, ii = np.append(1 / mass, 0.0), np.append(2 / (mass * radius**2), 0.0)
        block = cls(pose, v, im, ii)
        for a in range(n):
            for b in range(a + 1, n):
                d = position[b] - position[a]
                r = float(np.hypot(*d))
                if r <= (radius[a] + radius[b]) * (1 + touch):
                    x, y = position[a] + d / r * radius[a]
                    block.contacts.append((a, b, *(d / r), x, y))
        return block

    def wall(self, a: int, normal: tuple[float, float], reach: float) -> None:
        """Body a touches the ground in direction of the normal."""
        self.contacts.append((a, len(self.pose) - 1, *normal, *(self.pose[a, :2] + reach * np.array(normal))))

    def solve(self, e: float, mu: float, owed: float = 0.0) -> None:
        """Set `status`, `after`, `impulses`, `loss`, `out`."""
        m, n = len(self.contacts), len(self.pose) - 1
        self.rows, self.impulses = rows(Row, m), np.zeros((m, 2))
        for i, (a, b, nx, ny, px, py) in enumerate(self.contacts):
            row = self.rows[i]
            row.a, row.b, row.nx, row.ny, row.elasticity, row.friction = a, b, nx, ny, e, mu
            place_row(row, px, py, self.pose, self.im, self.ii)
        self.after, self.out = self.velocity.copy(), rows(Solved, 1)
        problem = Problem(self.rows, self.im, self.ii, self.pose, n, m)
        self.status = solve_block(problem, self.impulses, self.after, owed, False, self.out)
        self.loss = np.array([losses_of(problem, self.impulses, self.after, i) for i in range(m)]).reshape(m, 2)

    def energy(self, v: Floats) -> float:
        n = len(self.pose) - 1
        turning = self.ii[:n] > 0
        spin = np.where(turning, v[:n, 2] ** 2 / np.where(turning, self.ii[:n], 1.0), 0.0)
        return float(0.5 * ((v[:n, 0] ** 2 + v[:n, 1] ** 2) / self.im[:n] + spin).sum())
