"""One body on a plane or a fixed disk, against closed forms (g = 9.81 in units of the size)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ..packed import Thing, World, box, disk
from .pile import Pile, rectangle

G = 9.81
UNITS = [1e-3, 1.0, 1e3]


def on_plane(
    angle: float, mu: float, thing: Thing, moment: float, unit: float = 1.0, e: float = 0.0, mass: float = 1.0
) -> Pile:
    """A body on the line y = 0, with gravity turned by the slope's angle."""
    gravity = (G * unit * math.sin(angle), -G * unit * math.cos(angle))
    floor = [([(-1000.0 * unit, 0.0), (1000.0 * unit, 0.0)], 0.0)]
    return Pile(World([thing], floor), [mass], [mass * moment], gravity, e, mu)


def cube(unit: float, rate: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Thing:
    return Thing(box(unit, unit), (0.0, 0.5 * unit, 0.0), rate)


def wheel(unit: float, rate: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Thing:
    return Thing(disk(0.5 * unit), (0.0, 0.5 * unit, 0.0), rate)


@pytest.mark.parametrize("unit", UNITS)
def test_box_sticks_on_a_slope(unit: float) -> None:
    pile = on_plane(math.radians(20), 0.5, cube(unit), unit**2 / 6, unit)
    pile.run(10000 if unit == 1.0 else 500, 1 / 60)
    assert np.abs(pile.pose[0] - [0, 0.5 * unit, 0]).max() <= 1e-9 * unit
    assert pile.v[0, 0] == pytest.approx(0.0, abs=1e-12 * unit)


@pytest.mark.parametrize("unit", UNITS)
def test_a_box_that_comes_down_slowly_stands_on_its_floor_at_the_end_of_the_step(unit: float) -> None:
    h, gap, speed = 1 / 60, 1e-3 * unit, 0.05 * unit  # it would be 1 mm deep without the floor
    pile = on_plane(
        0.0, 0.0, Thing(box(unit, unit), (0.0, 0.5 * unit + gap, 0.0), (0.0, -speed, 0.0)), unit**2 / 6, unit
    )
    pile.step(h)
    assert pile.pose[0, 1] == pytest.approx(0.5 * unit, abs=1e-14 * unit)
    assert pile.v[0, 1] == pytest.approx(speed - 2.0 * gap / h, rel=1e-11)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("h", [1 / 30, 1 / 1000])
def test_box_slides_on_a_steeper_one(unit: float, h: float) -> None:
    """s = (1/2) g (sin - mu cos) t^2."""
    angle, mu = math.radians(30), 0.3
    pile = on_plane(angle, mu, cube(unit), unit**2 / 6, unit).run(round(1 / h), h)
    assert pile.pose[0, 0] == pytest.approx(0.5 * G * unit * (math.sin(angle) - mu * math.cos(angle)), rel=1e-13)
    assert abs(pile.pose[0, 2]) <= 1e-14


@pytest.mark.parametrize("unit", UNITS)
def test_disk_rolls_down_without_a_loss(unit: float) -> None:
    """Acceleration (2/3) g sin while tan <= 3 mu."""
    angle = math.radians(30)
    pile = on_plane(angle, 0.3, wheel(unit), unit**2 / 8, unit).run(60, 1 / 60)
    assert pile.v[0, 0] == pytest.approx(2 / 3 * G * unit * math.sin(angle), rel=1e-13)
    assert max(abs(pile.ledger.restitution), abs(pile.ledger.friction)) <= 1e-13 * pile.kinetic()


def test_disk_slips_on_a_steep_slope() -> None:
    """Beyond tan = 3 mu: a = g (sin - mu cos), spin rate 2 mu g cos / r."""
    angle, mu = math.radians(50), 0.2
    pile = on_plane(angle, mu, wheel(1.0), 1 / 8).run(60, 1 / 60)
    assert pile.v[0, 0] == pytest.approx(G * (math.sin(angle) - mu * math.cos(angle)), rel=1e-13)
    assert abs(pile.v[0, 2]) == pytest.approx(2 * mu * G * math.cos(angle) / 0.5, rel=1e-13)


@pytest.mark.parametrize("unit", UNITS)
def test_sliding_disk_comes_to_roll(unit: float) -> None:
    """v = (2/3) v0, and a third of the energy is lost to friction."""
    pile = on_plane(0.0, 0.3, wheel(unit, (2.0 * unit, 0.0, 0.0)), unit**2 / 8, unit).run(120, 1 / 60)
    assert pile.v[0, 0] == pytest.approx(4 / 3 * unit, rel=1e-13)
    assert pile.ledger.friction == pytest.approx(2 / 3 * unit**2, rel=1e-13)


def test_spun_disk_set_down_and_back_spin() -> None:
    """v = omega r / 3; a disk with back-spin omega r = -2 v stops dead."""
    pile = on_plane(0.0, 0.3, wheel(1.0, (0.0, 0.0, -6.0)), 1 / 8).run(120, 1 / 60)
    assert pile.v[0, 0] == pytest.approx(1.0, rel=1e-13)
    pile = on_plane(0.0, 0.3, wheel(1.0, (2.0, 0.0, 8.0)), 1 / 8).run(120, 1 / 60)
    assert np.abs(pile.v[0]).max() <= 1e-13


@pytest.mark.parametrize(("slope", "falls"), [(0.4999, False), (0.5001, True)])
def test_box_topples_at_its_ratio_of_sides(slope: float, falls: bool) -> None:
    thing = Thing(box(0.5, 1.0), (0.0, 0.5, 0.0))
    pile = on_plane(math.atan(slope), 5.0, thing, rectangle(1.0, 0.5, 1.0)).run(600, 1 / 60)
    assert (abs(pile.pose[0, 2]) > 0.5) == falls
    if not falls:
        assert np.abs(pile.pose[0] - [0, 0.5, 0]).max() <= 1e-8


@pytest.mark.parametrize("e", [0.0, 0.5, 0.8])
def test_bounces_end_about_when_they_should(e: float) -> None:
    """t = sqrt(2 h / g) (1 + e)/(1 - e), to a step or two; all the energy is restitution's."""
    h = 1 / 240
    pile = on_plane(0.0, 0.0, Thing(disk(0.5), (0.0, 1.5, 0.0)), 1 / 8, e=e)
    start, t = pile.energy(), 0.0
    end = math.sqrt(2 / G) * (1 + e) / (1 - e)
    while np.abs(pile.v[0, 1]) > 1e-9 or pile.pose[0, 1] > 0.5 + 1e-6:
        pile.step(h)
        t += h
        assert t < end + 1.0
    assert t == pytest.approx(end, abs=0.03 * end + 3 * h)
    assert start - pile.energy() == pytest.approx(pile.ledger.restitution - pile.ledger.lifted, rel=1e-12)


def test_block_on_a_belt_catches_up() -> None:
    """Speed V at t = V / (mu g); the belt gives twice the energy that the block gets; friction takes the other half."""
    mu, speed, h = 0.25, 1.5, 1 / 200
    pile = on_plane(0.0, mu, cube(1.0), 1 / 6)
    # As in pymunk, the surface's velocity is that of the shape's skin against its body: things go the other way.
    pile.world.shape[1].surface_x = -speed
    steps = math.ceil(speed / (mu * G) / h) + 2
    pile.run(steps, h)
    assert abs(pile.v[0, 0]) == pytest.approx(speed, rel=1e-12)
    assert pile.ledger.friction == pytest.approx(0.5 * speed**2, rel=1e-2)
    assert pile.ledger.carried == pytest.approx(pile.ledger.friction + 0.5 * speed**2, rel=1e-12)


def test_kinematic_platform_carries_a_box() -> None:
    things = [cube(1.0), Thing(box(20.0, 1.0), (0.0, -0.5, 0.0), (0.7, 0.3, 0.0), moves=False)]
    pile = Pile(World(things), [1.0], [1 / 6], (0.0, -G), 0.0, 0.5).run(120, 1 / 60)
    assert np.abs(pile.v[0] - [0.7, 0.3, 0]).max() <= 1e-12
    assert pile.worst_closure <= 1e-12
    # The platform's work: the box's kinetic energy and height, and what friction and the first blow took.
    assert pile.ledger.carried == pytest.approx(
        pile.energy() - 0.5 * G + (pile.ledger.restitution + pile.ledger.friction) - pile.ledger.lifted, rel=1e-12
    )


@pytest.mark.parametrize("mu", [0.0, 5.0])
def test_sliding_and_rolling_on_a_curve_is_second_order(mu: float) -> None:
    """theta'' = f g sin(theta) / (R + r), f = 1 for sliding, 2/3 for rolling down a fixed disk."""
    R, r, theta, speed, T = 1.0, 0.1, 0.2, 0.5, 0.2
    factor, spin = (1.0, 0.0) if mu == 0.0 else (2 / 3, -speed / r)
    end = solve_ivp(
        lambda _, y: [y[1], factor * G / (R + r) * math.sin(y[0])], (0, T), [theta, speed / (R + r)],
        rtol=1e-12, atol=1e-14,
    ).y[0, -1]  # fmt: skip
    errors = []
    for h in (8e-3, 4e-3, 2e-3):
        thing = Thing(
            disk(r), ((R + r) * math.sin(theta), (R + r) * math.cos(theta), 0.0),
            (speed * math.cos(theta), -speed * math.sin(theta), spin),
        )  # fmt: skip
        pile = Pile(World([thing], [([(0.0, 0.0)], R)]), [1.0], [0.5 * r * r], (0.0, -G), 0.0, mu)
        pile.run(round(T / h), h)
        errors.append(float(np.hypot(*(pile.pose[0, :2] - (R + r) * np.array([math.sin(end), math.cos(end)])))))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.abs(orders - 2.0).max() <= 0.1
    assert errors[0] <= 1e-5
