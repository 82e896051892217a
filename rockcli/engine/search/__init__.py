"""The lowest overturning value of a range, by trials."""
