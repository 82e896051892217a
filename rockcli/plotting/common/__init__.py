"""What figures share: cases and their names, panels of the ground, bodies, styles."""
