"""Tests of pymunk's own suite that do not pass when `Space.step` is ours, each with its reason.

The same list stands in docs/pymunk.md. A test that begins to pass has to leave it.
"""

FIRST_ORDER = "digits of pymunk's first-order path; ours is the exact one"
REHEARSED = (
    "numbers of an arbiter at the end of pymunk's first-order path; a rehearsal goes to the end of the exact one"
)
NAMED = "expects AssertionError for bodies without mass; ours is a ValueError that tells the remedy"
OUTSIDE = "a body outside the space holds like a wall; pymunk's solver lets it take its share of the impulse"

DIFFERS = {
    "test_arbiter.UnitTestArbiter.testContactPointSet": REHEARSED,
    "test_arbiter.UnitTestArbiter.testFriction": (
        "the disk sticks where it lands, as Coulomb's law says; pymunk's slides for its first step"
    ),
    "test_arbiter.UnitTestArbiter.testImpulse": REHEARSED,
    "test_arbiter.UnitTestArbiter.testNormal": REHEARSED,
    "test_arbiter.UnitTestArbiter.testRestitution": FIRST_ORDER,
    "test_arbiter.UnitTestArbiter.testSurfaceVelocity": REHEARSED,
    "test_arbiter.UnitTestArbiter.testTotalKE": REHEARSED,
    "test_batch.UnitTestBatch.test_get_arbiters": (
        "a depth of 17 has the same 15 digits where it is read twice, not 16"
    ),
    "test_body.UnitTestBody.test_mass": NAMED,
    "test_body.UnitTestBody.test_moment": NAMED,
    "test_constraint.UnitTestConstraint.testImpulse": OUTSIDE,
    "test_constraint.UnitTestDampedRotarySpring.testTorqueFunc": FIRST_ORDER,
    "test_constraint.UnitTestDampedSpring.testForceFunc": FIRST_ORDER,
    "test_space.UnitTestSpace.testPickleCachedArbiters": (
        "compares two steps of a space with three of its copy; ours move disks made in one another apart in each"
    ),
    "test_space.UnitTestSpace.testReindexStaticCollision": (
        "expects that a wall made longer is not felt before reindex_static; ours is felt at once"
    ),
}
