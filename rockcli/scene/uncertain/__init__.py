"""Numbers that are not known for certain: distributions, samples, and statistics of what they make."""
