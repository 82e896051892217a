"""The study file: read, check, and turn into batches of cases.  The front door is `open.open_study`."""
