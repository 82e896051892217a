"""SIMD batches under one sampled motion: all lanes step through the samples together (docs/lanes.md)."""
