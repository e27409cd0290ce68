"""Modules that the tests of regression/ share. A test finds the package beside it, by a link where its folder lies deeper."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "python"))  # soil_mpm lies there
