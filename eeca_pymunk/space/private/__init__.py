"""Private names of pymunk, one function each: no other file of this package uses one.

In: pymunk's objects, or their C structures.  Out: values, memory that pymunk's batch calls fill, or an ImportError that
says which name the installed pymunk lacks.  Open `spaces.py` first; `versions.py` has what differs between pymunk's
versions. OF_LIBRARY and TYPES of a file are names in Chipmunk's library that it uses; those of `rest.py`, which imports
`spaces.py`, and of `versions.py` are there; `spaces.check` looks them up.
"""
