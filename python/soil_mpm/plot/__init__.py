"""Pictures of runs, for scripts/plot and its kin. Without a display of its own (a notebook has one) matplotlib draws to files."""

import sys

import matplotlib

if "matplotlib.pyplot" not in sys.modules:
    matplotlib.use("Agg")
