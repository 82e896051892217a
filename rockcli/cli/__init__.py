"""The command line: talks to people, one file per command."""

import os

# dense algebra here is of small matrices, where threads cost more than they bring; to be said before numpy is imported
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# figures are files: a notebook passes the name of its own way of showing them on to commands, who may not have it
os.environ.pop("MPLBACKEND", None)
