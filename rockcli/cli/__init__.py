"""The command line: talks to people, one file per command."""

import os

# dense algebra here is of small matrices, where threads cost more than they bring; to be said before numpy is imported
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
