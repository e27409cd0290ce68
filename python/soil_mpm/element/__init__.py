"""Laboratory tests of a single material point, and fits to them."""
