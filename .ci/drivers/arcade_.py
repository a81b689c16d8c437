"""arcade's PymunkPhysicsEngine without a window: a hero runs, jumps and pushes crates on tiles; a platform moves."""

import os
import sys

from watched import tell, watch

os.environ["ARCADE_HEADLESS"] = "True"
watch(sys.argv)
import arcade

engine = arcade.PymunkPhysicsEngine(damping=0.9, gravity=(0, -1500))
color = arcade.color.GRAY


def box(size, x, y):
    sprite = arcade.SpriteSolidColor(size, size, center_x=x, center_y=y, color=color)
    return sprite


tiles = [box(64, 32 + 64 * k, 32) for k in range(16)]
for tile in tiles:
    engine.add_sprite(tile, friction=0.7, collision_type="wall", body_type=arcade.PymunkPhysicsEngine.STATIC)
crates = [box(48, 420 + 60 * k, 64 + 24 + 48 * row) for k in range(3) for row in range(3)]
for crate in crates:
    engine.add_sprite(crate, mass=2.0, friction=0.6, collision_type="item")
hero = box(48, 100, 64 + 24)
engine.add_sprite(
    hero, mass=2.0, friction=1.0, moment_of_inertia=arcade.PymunkPhysicsEngine.MOMENT_INF, damping=0.4,
    collision_type="player", max_horizontal_velocity=450, max_vertical_velocity=1600,
)  # fmt: skip
moving = box(64, 100, 260)
engine.add_sprite(moving, body_type=arcade.PymunkPhysicsEngine.KINEMATIC, collision_type="wall")
hits = []
engine.add_collision_handler("player", "item", post_handler=lambda *_: hits.append(1))
grounded = 0
for k in range(400):
    engine.set_velocity(moving, (60 if (k // 100) % 2 == 0 else -60, 0))
    grounded += engine.is_on_ground(hero)
    engine.set_friction(hero, 0)
    engine.apply_force(hero, (8000 if k < 250 else -8000, 0))
    if k % 90 == 60 and engine.is_on_ground(hero):
        engine.apply_impulse(hero, (0, 1800))
    engine.step()
tell({
    "hero x": hero.center_x, "hero y": hero.center_y, "steps on ground": grounded, "calls of the handler": len(hits),
    "crate y, highest": max(c.center_y for c in crates),
})  # fmt: skip
