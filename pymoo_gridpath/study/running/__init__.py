"""Runs of a study carried out and kept."""
