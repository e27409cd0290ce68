"""Modules that the commands of scripts/ and regression/ share. A command finds the package beside it."""
