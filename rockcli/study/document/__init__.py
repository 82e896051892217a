"""The study file: YAML with places, expressions, settings laid over it, and the check against the schema."""
