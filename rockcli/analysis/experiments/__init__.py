"""Predictions against experiments with two outcomes: scores, baselines, and what experiments say of a body."""
