"""`python -m pipeline.cli` is `fibertwin`."""

from pipeline.cli import main

main()
