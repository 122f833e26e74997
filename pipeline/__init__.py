"""fibertwin: from a fiber mat to a CFD case one can trust."""
