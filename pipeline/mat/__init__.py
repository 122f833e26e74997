"""Random fiber mats: drawn, deposited, measured, exchanged."""
