"""A case run many times: keys swept, seeds repeated, means with their confidence."""
