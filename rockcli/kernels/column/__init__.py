"""The flexible column on its base: modal steps exact in time, events located (docs/flexible.md)."""
