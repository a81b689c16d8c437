"""Pictures and films, headless: matplotlib's Agg canvas, never a display. The only importer of matplotlib."""

from .film import animate, player
from .pictures import figure, save_picture, snapshot, strip

__all__ = ["animate", "figure", "player", "save_picture", "snapshot", "strip"]
