"""Suites of tests that a class of one's own inherits and has to pass, and slow references that they check against."""
