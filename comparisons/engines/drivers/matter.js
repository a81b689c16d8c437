// matter-js: a scene from standard input, states and seconds to standard output.
// It counts in pixels and milliseconds, with y downwards: a metre is 100 pixels here. Its friction is not Coulomb's.
const Matter = require("matter-js");
const job = JSON.parse(require("fs").readFileSync(0, "utf8"));
const PIXELS = 100, THICK = 1000, BASE = 1000 / 60; // BASE: ms, in which it counts velocities
const { Body, Bodies, Composite, Constraint, Engine } = Matter;

function build() {
  const engine = Engine.create();
  // Its acceleration is gravity.y * scale, in pixels/ms².
  engine.gravity.y = 1;
  engine.gravity.scale = (job.gravity * PIXELS) / 1e6;
  const matter = {
    friction: job.friction, frictionStatic: job.friction ? 1 : 0, frictionAir: 0, restitution: job.elasticity,
  };
  for (const [x, y, u, v] of job.walls) {
    const d = Math.hypot(u - x, v - y), c = (u - x) / d, s = (v - y) / d, deep = (0.5 * THICK) / PIXELS;
    const wall = Bodies.rectangle(
      (0.5 * (x + u) + deep * s) * PIXELS, -(0.5 * (y + v) - deep * c) * PIXELS, d * PIXELS + 2 * THICK, THICK,
      { ...matter, isStatic: true, angle: -Math.atan2(s, c) });
    Composite.add(engine.world, wall);
  }
  const bodies = job.start.map(([x, y, angle, vx, vy, spin], i) => {
    const r = job.radius[i] * PIXELS;
    const body = r ? Bodies.circle(x * PIXELS, -y * PIXELS, r, matter)
      : Bodies.rectangle(x * PIXELS, -y * PIXELS, PIXELS, PIXELS, matter);
    Body.setAngle(body, -angle);
    Body.setMass(body, 1);
    Body.setInertia(body, job.moment[i] * PIXELS * PIXELS);
    if (job.rod) body.collisionFilter.mask = 0;
    Body.setVelocity(body, { x: (vx * PIXELS * BASE) / 1000, y: (-vy * PIXELS * BASE) / 1000 });
    Body.setAngularVelocity(body, (-spin * BASE) / 1000);
    Composite.add(engine.world, body);
    return body;
  });
  if (job.rod) {
    Composite.add(engine.world, Constraint.create({ pointA: { x: 0, y: 0 }, bodyB: bodies[0], stiffness: 1 }));
  }
  return [engine, bodies];
}

function run(steps) {
  const [engine, bodies] = build(), states = [], rate = 1000 / BASE / PIXELS;
  let seconds = 0;
  for (let k = 0; k < steps; k += job.every) {
    const begun = process.cpuUsage();
    for (let i = 0; i < Math.min(job.every, steps - k); i++) Engine.update(engine, 1000 * job.dt);
    seconds += process.cpuUsage(begun).user / 1e6;
    states.push(bodies.map((b) => {
      const v = Body.getVelocity(b);
      return [b.position.x / PIXELS, -b.position.y / PIXELS, -b.angle, v.x * rate, -v.y * rate,
        (-Body.getAngularVelocity(b) * 1000) / BASE];
    }));
  }
  return { states, seconds };
}

for (const until = performance.now() + 500; performance.now() < until; ) run(Math.min(100, job.steps)); // gets it compiled
const ended = [run(job.steps)];
while (ended.reduce((sum, one) => sum + one.seconds, 0) < job.enough && ended.length < 9) ended.push(run(job.steps));
console.log(JSON.stringify({ states: ended[0].states, seconds: Math.min(...ended.map((one) => one.seconds)) }));
