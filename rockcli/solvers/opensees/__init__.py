"""The backend `opensees`: a plain OpenSeesPy script per case, run in a process of its own (docs/opensees.md).

The script the backend runs is the one `rock export` writes: what an engineer carries on from is what was solved.
"""
