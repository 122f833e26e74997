"""`python -m pipeline.cli` is `fibertwin`."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.cli.entry import main

if __name__ == "__main__":
    main()
