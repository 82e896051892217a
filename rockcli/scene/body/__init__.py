"""The body: two edges or an outline, how it rests, and the column that bends."""
