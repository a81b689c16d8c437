"""Box2D v3 through pyb2d3: a space (`described.py`) from standard input, states and seconds to standard output.

Settings are those it ships with: 4 substeps, impacts below 1 m/s without restitution. Bodies do not sleep.
"""

import json
import sys
import time

import pyb2d3 as b2

job = json.load(sys.stdin)
SUBSTEPS = 4


def shape_of(told):
    if "centre" in told:
        return b2.circle(center=tuple(told["centre"]), radius=told["radius"])
    vertices = [tuple(v) for v in told["vertices"]]
    if len(vertices) > 2:
        return b2.polygon(points=vertices, radius=told["radius"])
    if told["radius"] > 0.0:
        return b2.capsule(*vertices, told["radius"])
    return b2.segment(*vertices)


def add_joint(world, bodies, told):
    a, b = (bodies[k] for k in told["bodies"])
    common = {
        "body_a": a, "body_b": b, "local_anchor_a": tuple(told["anchors"][0]),
        "local_anchor_b": tuple(told["anchors"][1]),
"collide_connected": told["collide"],
    }  # fmt: skip
    if told["length"] is not None:
        world.create_joint(b2.distance_joint_def(length=told["length"], **common))
        return
    if told["limits"] is not None:
        common |= {"enable_limit": True, "lower_angle": told["limits"][0], "upper_angle": told["limits"][1]}
    world.create_joint(b2.revolute_joint_def(**common))


def build():
    world = b2.World(gravity=tuple(job["gravity"]))
    world.sleeping_enabled = False
    bodies = []
    for told in job["bodies"]:
        x, y, angle, vx, vy, spin = told["state"]
        body = world.create_body(
            type=getattr(b2.BodyType, told["kind"]), position=(x, y), rotation=b2.make_rot(angle),
            linear_velocity=(vx, vy), angular_velocity=spin,
        )  # fmt: skip
        for each in told["shapes"]:
            definition = b2.shape_def(density=1.0)
            definition.material = b2.surface_material(friction=each["friction"], restitution=each["elasticity"])
            if each["group"]:
                definition.filter = b2.make_filter(group_index=-each["group"])
            body.create_shape(definition, shape_of(each))
        if told["kind"] == "DYNAMIC":
            mass = b2.MassData()
            mass.mass, mass.rotational_inertia, mass.center = told["mass"], told["moment"], (0.0, 0.0)
            body.mass_data = mass
        bodies.append(body)
    for told in job["joints"]:
        add_joint(world, bodies, told)
    return world, bodies[: job["count"]]


def run(steps):
    world, bodies = build()
    seconds, states = 0.0, []
    for k in range(0, steps, job["every"]):
        begun = time.process_time()
        for _ in range(min(job["every"], steps - k)):
            world.step(job["dt"], SUBSTEPS)
        seconds += time.process_time() - begun
        states.append([(*b.position, b.angle, *b.linear_velocity, b.angular_velocity) for b in bodies])
    return states, seconds


run(min(3, job["steps"]))
ended = [run(job["steps"])]
while sum(seconds for _, seconds in ended) < job["enough"] and len(ended) < 9:
    ended.append(run(job["steps"]))
print(json.dumps({"states": ended[0][0], "seconds": min(seconds for _, seconds in ended)}))
