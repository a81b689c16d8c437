"""Many arrays behind one pointer: how kernels take a scene.

In: a named tuple of arrays. Out: numbers that say where these are, which kernels take, and what opens them there.
"""

from .table import Opener, Table, table_of

__all__ = ["Opener", "Table", "table_of"]
