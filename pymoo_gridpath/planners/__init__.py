"""Planners that are no evolutionary searches, as algorithms of pymoo."""
