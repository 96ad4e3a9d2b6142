"""Statistical tests of a report."""
