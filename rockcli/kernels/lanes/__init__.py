"""Many symmetric bodies at once in SIMD batches of the same automaton (docs/lanes.md)."""
