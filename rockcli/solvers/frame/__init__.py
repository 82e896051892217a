"""The backend `frame`: beams on a yielding base, stepped in time, as the thesis did with OpenSees (docs/frame.md).

It shares nothing with the event-driven solvers but the scene: a second opinion on them, and a way to see what a
finite-element code makes of a body whose base opens and closes.
"""
