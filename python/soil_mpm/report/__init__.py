"""A report of a run as one HTML file that needs nothing else: docs/report.md."""

from soil_mpm.report.page import write

__all__ = ["write"]
