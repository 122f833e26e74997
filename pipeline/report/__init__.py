"""One page that says what was made and whether to trust it."""
