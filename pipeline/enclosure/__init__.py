"""The mat in its duct: the air as a closed surface with named patches."""
