"""A manim-physics scene without a window or a film: circles and rectangles fall on a floor between walls."""

import sys

from watched import tell, watch

watch(sys.argv)
from manim import DOWN, LEFT, RIGHT, UP, Circle, Line, Rectangle, tempconfig
from manim_physics import SpaceScene


class Falling(SpaceScene):
    def construct(self):
        things = [Circle(radius=0.3).move_to((k - 2) * 0.8 * RIGHT + (1 + 0.7 * k) * UP) for k in range(5)]
        things += [
            Rectangle(width=0.8, height=0.5).move_to((k - 2) * 0.7 * RIGHT + (2 + 0.9 * k) * UP) for k in range(4)
        ]
        floor = Line(LEFT * 4 + DOWN * 3.5, RIGHT * 4 + DOWN * 3.5)
        walls = [Line(x * RIGHT + DOWN * 3.5, x * RIGHT + UP * 6) for x in (-4, 4)]
        self.add(*things, floor, *walls)
        self.make_rigid_body(*things, elasticity=0.6)
        for one in (floor, *walls):
            self.make_static_body(one)
        self.wait(5)
        self.things = things


with tempconfig({"dry_run": True, "quality": "low_quality", "frame_rate": 60, "progress_bar": "none"}):
    scene = Falling()
    scene.render()
tell({
    "lowest y": min(t.body.position.y for t in scene.things),
    "mean y": sum(t.body.position.y for t in scene.things) / 9,
    "fastest at the end": max(t.body.velocity.length for t in scene.things),
})  # fmt: skip
