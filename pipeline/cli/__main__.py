"""`python -m pipeline.cli` is `fibertwin`."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.cli.app import main

main()
