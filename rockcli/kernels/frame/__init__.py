"""The column as beam elements on a unilateral base, in Newmark's steps (docs/frame.md)."""
