"""Rasters of terrain and random fields."""
