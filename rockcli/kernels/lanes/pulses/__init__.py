"""SIMD batches under pulses: each lane at its own pace, refilled as its case ends (docs/lanes.md)."""
