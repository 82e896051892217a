"""The version of rockcli."""

__version__ = "0.1.0"
