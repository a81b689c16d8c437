"""Side-by-side comparisons: `python -m comparisons NAME --out DIR`."""
