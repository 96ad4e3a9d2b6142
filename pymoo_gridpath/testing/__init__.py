"""Conformance suites: pytest classes that whoever adds something of their own inherits from."""

from pymoo_gridpath.testing.maps import MapFormatSuite

__all__ = ["MapFormatSuite"]
