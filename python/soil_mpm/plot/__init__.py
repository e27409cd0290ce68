"""Pictures of runs, for scripts/plot and its kin."""
