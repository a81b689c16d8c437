"""Pictures and films, without a display (matplotlib's Agg canvas). No other room imports matplotlib.

In: spaces and recordings. Out: pictures, films (GIF, MP4, HTML), the player of a notebook. Open `pictures.py` first,
single pictures; `film.py` makes films of recordings, `drawing.py` draws shapes, `traces.py` the plots below a film,
`encode.py` writes files.
"""

from .film import animate, player
from .pictures import figure, save_picture, snapshot, strip

__all__ = ["animate", "figure", "player", "save_picture", "snapshot", "strip"]
