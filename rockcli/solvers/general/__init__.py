"""The backend `scipy`: general methods for ordinary differential equations, with and without located events.

It shares no formula with the kernels but the table of models: a second opinion on them, and a way to see what an
ordinary solver makes of a body whose equation jumps at every impact (the thesis's Fig. 3).
"""
