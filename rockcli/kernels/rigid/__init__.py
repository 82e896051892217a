"""One rigid body at a time: the rocking automaton, its flow, guards and resets (docs/theory.md)."""
