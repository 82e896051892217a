"""Figures from a dataset and nothing else, so that an old file can be drawn for ever.

One kind of figure per file; matplotlib's objects are used directly, never pyplot.
"""
