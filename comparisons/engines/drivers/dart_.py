"""DART through dartpy: a scene from standard input, states and seconds to standard output.

Bodies have planar joints; disks are spheres, walls thick boxes. The pendulum has a revolute joint, which cannot come
apart. Collisions are found by the detector that knows spheres and boxes exactly.
"""

import json
import math
import sys
import time

import dartpy as dart
import numpy as np

job = json.load(sys.stdin)
THICK = 10.0  # m, of walls


def rub(node):
    aspect = node.getDynamicsAspect()
    # The smaller friction and the product of elasticities count.
    aspect.setFrictionCoeff(job["friction"])
    aspect.setRestitutionCoeff(math.sqrt(job["elasticity"]))


def build():
    world = dart.simulation.World()
    world.setGravity([0, -job["gravity"], 0])
    world.setTimeStep(job["dt"])
    world.getConstraintSolver().setCollisionDetector(dart.collision.DARTCollisionDetector())
    for x, y, u, v in job["walls"]:
        d = math.hypot(u - x, v - y)
        skeleton = dart.dynamics.Skeleton()
        joint, body = skeleton.createWeldJointAndBodyNodePair()
        shape = dart.dynamics.BoxShape([d + 2 * THICK, THICK, THICK])
        node = body.createShapeNode(shape)
        node.createVisualAspect()
        node.createCollisionAspect()
        node.createDynamicsAspect()
        rub(node)
        place = dart.math.Isometry3()
        c, s = (u - x) / d, (v - y) / d
        place.set_rotation(np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]))
        place.set_translation([0.5 * (x + u) + 0.5 * THICK * s, 0.5 * (y + v) - 0.5 * THICK * c, 0])
        joint.setTransformFromParentBodyNode(place)
        skeleton.setMobile(False)
        world.addSkeleton(skeleton)
    skeletons = []
    for (x, y, angle, vx, vy, spin), radius, moment in zip(job["start"], job["radius"], job["moment"], strict=True):
        skeleton = dart.dynamics.Skeleton()
        if job["rod"]:
            joint, body = skeleton.createRevoluteJointAndBodyNodePair()
            joint.setAxis([0, 0, 1])
            body.setInertia(dart.dynamics.Inertia(1.0, np.array([x, y, 0.0]), 1e-12 * np.eye(3)))
        else:
            joint, body = skeleton.createPlanarJointAndBodyNodePair()
            body.setInertia(dart.dynamics.Inertia(1.0, np.zeros(3), moment * np.eye(3)))
            shape = dart.dynamics.SphereShape(radius) if radius else dart.dynamics.BoxShape([1, 1, 1])
            node = body.createShapeNode(shape)
            node.createVisualAspect()
            node.createCollisionAspect()
            node.createDynamicsAspect()
            rub(node)
            skeleton.setPositions(np.array([x, y, angle]))
            skeleton.setVelocities(np.array([vx, vy, spin]))
        world.addSkeleton(skeleton)
        skeletons.append(skeleton)
    return world, skeletons


def state(skeletons):
    if job["rod"]:
        x, y = job["start"][0][:2]
        (q,), (w,) = skeletons[0].getPositions(), skeletons[0].getVelocities()
        c, s = math.cos(q), math.sin(q)
        x, y = c * x - s * y, s * x + c * y
        return [(x, y, q, -w * y, w * x, 0.0)]
    return [(*s.getPositions().tolist(), *s.getVelocities().tolist()) for s in skeletons]


def run(steps):
    world, skeletons = build()
    seconds, states = 0.0, []
    for k in range(0, steps, job["every"]):
        begun = time.process_time()
        for _ in range(min(job["every"], steps - k)):
            world.step()
        seconds += time.process_time() - begun
        states.append(state(skeletons))
    return states, seconds


run(min(3, job["steps"]))
ended = [run(job["steps"])]
while sum(seconds for _, seconds in ended) < job["enough"] and len(ended) < 9:
    ended.append(run(job["steps"]))
print(json.dumps({"states": ended[0][0], "seconds": min(seconds for _, seconds in ended)}))
