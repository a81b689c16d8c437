"""Records: what the rows of the packed arrays mean.

In: nothing. Out: records of bodies, shapes, contacts and steps, and the scene that all kernels take.
Open `bodies.py` first.

A record is a class of named numbers, float or int, each of 64 bits; an array of records is a numpy array with that
dtype. Kernels read and write `bodies[i].vx`; numpy code takes columns, `bodies["vx"]`. `..compiled.records` has
the mechanism.
"""
