"""Where `fibertwin` starts: ready for signals and for whoever reads before anything that takes time is loaded."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.cli.interruption import interruptible


def main() -> None:
    """Run the command line, from its first moment to its last word."""
    with interruptible():
        from pipeline.cli.outlets import steady

        steady()
        from pipeline.cli.app import main as run_command

        run_command()
