"""The step: bodies on their paths from one computed time of impact to the next.

In: the packed arrays of a world (`..model.scene`) at the start of a step. Out: the same at its end, and a log of
impulses. Open `step.py` first, the stages of a step: `begin.py`, islands and intervals (`intervals.py`), the queue of
events in `loop.py`, `close.py`. An impact acts on one disk (`..contacts.single`) or on all bodies that touch
(`simultaneous.py`, `resolution.py`; `joint_impact.py` and `joint_answers.py` if joints hold any of them). `midstep.py`
solves all contacts of a step at once; `run.py` takes many steps in one call.

`scene.py` owns the arrays, in memory of `scene_memory.py`; `memory.py` and `remembering.py` store what a state of a run
consists of, `edits.py` writes what programs edit in place, and `taking_over.py` what a new scene has of the last one.

Names of arguments: A is the scene, P the one before, J its joints (`..model.joints`), R the reading of the space
(`..model.values`) with the arrays exchanged with pymunk (`..layout`), F the arrays of a run (`..model.run`). V are
velocities and L impulses of contacts (normal, tangential), OUT the report of a solve (`Solved`), `owed` energy that a
solve has to lose. Bits and negative codes are the status of a step, see `model/step.py`. A block is the set of bodies
and contacts of a simultaneous impact, in A.BLOCK.
"""
