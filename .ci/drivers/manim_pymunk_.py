"""A manim-pymunk scene without a window or a film: dots and a square fall on a floor; a handler hears them."""

import sys

from watched import tell, watch

watch(sys.argv)
from manim import DOWN, LEFT, RIGHT, UP, Dot, Line, Square, tempconfig
from manim_pymunk import SpaceScene

heard = []


class Falling(SpaceScene):
    def construct(self):
        floor = Line(start=LEFT * 5, end=RIGHT * 5, stroke_width=12)
        floor.to_edge(DOWN, buff=0.1)
        self.add_static_body(floor)
        dots = [Dot(radius=0.15).move_to((k % 5 - 2) * 0.5 * RIGHT + (k // 5) * 0.8 * UP) for k in range(15)]
        squares = [Square(0.6).move_to((k - 1) * 1.5 * RIGHT + 3 * UP) for k in range(3)]
        self.things = [*dots, *squares]
        self.add_dynamic_body(*self.things)
        self.set_collision_type(floor, *self.things, collision_type=7)

        def hear(arbiter, space, data):
            heard.append(arbiter.total_impulse.length)
            return True

        self.set_collision_detection_handler(collision_type_a=7, collision_type_b=7, post_solve=hear)
        self.wait(4)


with tempconfig({"dry_run": True, "quality": "low_quality", "frame_rate": 30, "progress_bar": "none"}):
    scene = Falling()
    scene.render()
bodies = [t.body for t in scene.things]
tell({
    "lowest y": min(b.position.y for b in bodies), "mean y": sum(b.position.y for b in bodies) / len(bodies),
    "fastest at the end": max(b.velocity.length for b in bodies), "calls of the handler": len(heard),
})  # fmt: skip
