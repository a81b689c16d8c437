"""Box2D 2.3 through pybox2d: a scene from standard input, states and seconds to standard output.

With "films" in it, each has its own "start", "radius", "moment" and "mass": lists of states and seconds come back.
"""

import json
import sys
import time

from Box2D import (
    b2_dynamicBody,
    b2BodyDef,
    b2CircleShape,
    b2DistanceJointDef,
    b2EdgeShape,
    b2FixtureDef,
    b2MassData,
    b2PolygonShape,
    b2World,
)

job = json.load(sys.stdin)
ITERATIONS = job.get("iterations", [8, 3])  # of velocities and positions, by default as its manual has them


def build():
    world = b2World(gravity=(0, -job["gravity"]), doSleep=False)
    ground = world.CreateStaticBody()
    for x, y, u, v in job["walls"]:
        edge = b2EdgeShape(vertices=[(x, y), (u, v)])
        ground.CreateFixture(b2FixtureDef(shape=edge, friction=job["friction"], restitution=job["elasticity"]))
    bodies = []
    masses = job.get("mass", [1.0] * len(job["start"]))
    for (x, y, angle, vx, vy, spin), radius, moment, mass in zip(
        job["start"], job["radius"], job["moment"], masses, strict=True
    ):
        body = world.CreateBody(
            b2BodyDef(type=b2_dynamicBody, position=(x, y), angle=angle, linearVelocity=(vx, vy), angularVelocity=spin)
        )
        shape = b2CircleShape(radius=radius) if radius else b2PolygonShape(box=(0.5, 0.5))
        body.CreateFixture(
            b2FixtureDef(shape=shape, density=1, friction=job["friction"], restitution=job["elasticity"])
        )
        body.massData = b2MassData(mass=mass, I=moment, center=(0, 0))
        bodies.append(body)
    if job["rod"]:
        rod = b2DistanceJointDef(bodyA=ground, bodyB=bodies[0], anchorA=(0, 0), anchorB=bodies[0].position)
        rod.length = (bodies[0].position - (0, 0)).length
        world.CreateJoint(rod)
    return world, bodies


def run(steps):
    world, bodies = build()
    seconds, states = 0.0, []
    for k in range(0, steps, job["every"]):
        begun = time.process_time()
        for _ in range(min(job["every"], steps - k)):
            world.Step(job["dt"], *ITERATIONS)
            world.ClearForces()
        seconds += time.process_time() - begun
        states.append([(*b.position, b.angle, *b.linearVelocity, b.angularVelocity) for b in bodies])
    return states, seconds


if "films" in job:
    films = []
    for film in job["films"]:
        job |= film
        states, seconds = run(job["steps"])
        films.append({"states": states, "seconds": seconds})
    print(json.dumps(films))
    sys.exit()
run(min(3, job["steps"]))
ended = [run(job["steps"])]
while sum(seconds for _, seconds in ended) < job["enough"] and len(ended) < 9:
    ended.append(run(job["steps"]))
print(json.dumps({"states": ended[0][0], "seconds": min(seconds for _, seconds in ended)}))
