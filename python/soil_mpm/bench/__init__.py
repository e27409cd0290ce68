"""Timed runs, their tables and figures, and the groups of tests for a GPU."""
