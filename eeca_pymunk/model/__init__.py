"""Records: what the rows of the packed arrays mean.

A record is a class of named numbers, float or int, each of 64 bits; an array of records is a numpy array with that
dtype. Kernels read and write `bodies[i].vx`; numpy code takes columns, `bodies["vx"]`. `..compiled.records` has
the mechanism.
"""
