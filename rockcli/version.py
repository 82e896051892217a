"""The version of rockcli."""

__version__ = "0.2.0"
