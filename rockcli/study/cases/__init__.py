"""The cases of a study: axes, tables, suites, and their batches."""
