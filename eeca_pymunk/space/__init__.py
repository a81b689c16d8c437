"""The edge: the only room that reads or writes pymunk; its private names are used in `private` only.

In: a `pymunk.Space`, its bodies, shapes, settings, functions and handlers. Out: arrays, and errors for unsupported
features. Back: the arrays of the end of a step, written into the space.

Open first `world.py`, the space as packed arrays, and `checks.py`, values that cannot be stepped. Words used
throughout: a body has an index in pymunk's order (`bodies.items`, `bodies.row`), and a row in BODY, which kernels use
(`IDS[BODY_ROW]`); a *function* is one of the program, which pymunk calls; *past* is the object of the same class for an
earlier reading of the space, of which everything that has not changed is used again.

| subject | files |
|---|---|
| reading bodies | `bodies.py` (also energy and momenta), `body_values.py` |
| reading shapes | `outlines.py` (also for pictures), `packing.py` |
| reading joints | `joints.py`, `constraints.py`, `listing.py`, `partners.py`, `spring_functions.py` |
| states in and out | `body_states.py` |
| edits by the program | `edits.py` (shapes, bodies), `listing.py` (joints), `patching.py` (rows after edits in place) |
| functions of the program | `hooks.py`; of handlers `rehearsal.py`, `handled_pairs.py`, `watched.py`, `decisions.py` |
| pymunk's shapes after a step | `sync.py`, `late_shapes.py` |
| what else pymunk shows of a step | `arbiters.py` (contacts), `constraint_impulses.py` |
| sleeping bodies | `sleeping.py`, `sleep_groups.py` |
| a line of text | `describe.py` |
| a space to step before those of programs | `small_space.py` |
| private names of pymunk | the room `private` |

Five files replace methods or properties of pymunk's classes, which then act as before for all other spaces:
`edits.py` (setters of shapes and bodies; `Body.sleep` at import), `listing.py` (`Constraint.__setattr__`),
`constraint_impulses.py` (`Constraint.impulse`), `arbiters.py` (`each_arbiter`, `batch.get_space_arbiters`,
`debug_draw`), `late_shapes.py` (queries, `Shape.bb`, `Space.remove`; `Space.use_spatial_hash` at import). They are not
restored.
"""
