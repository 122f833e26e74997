"""The command line: the only place that prints, and that turns errors into exit codes."""

from pipeline.cli.app import main

__all__ = ["main"]
