"""Recorded ground motions: reading, processing, measures.  The one door to ObsPy.

Light to import: ObsPy is imported only inside the functions that need it.
"""
