"""Records: what the rows of the packed arrays mean.

In: nothing. Out: records of bodies, shapes, contacts (`contacts.py`, `islands.py`), joints, steps (`step.py`, a run of
many in `run.py`) and of what pymunk has (`values.py`); the scene that all kernels take (`scene.py`; kernels of joints
take `Joints` as well); `parameters/`. Open `bodies.py` first.

A record is a class of named numbers, float or int, each of 64 bits; an array of records is a numpy array with that
dtype. Kernels read and write `bodies[i].vx`; numpy code takes columns, `bodies["vx"]`. `..compiled.records` has
the mechanism. In kernels `A` is the scene and `J` the joints, names in capitals are arrays.
"""
