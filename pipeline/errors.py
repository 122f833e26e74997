"""The errors that a user can mend; everything else is a bug and keeps its traceback.

Each message says what is wrong, how many or how much, where, and what to do.
The command line turns them into one line and an exit code; a library never exits.
"""

# SPDX-License-Identifier: GPL-3.0-or-later


class FibertwinError(Exception):
    """Something the user can mend; `exit_code` is what the command line ends with."""

    exit_code = 1


class CaseError(FibertwinError):
    """The case file, or an option that overrides it, asks for nonsense."""

    exit_code = 2


class StageError(FibertwinError):
    """A stage could not do what a valid case asks of it."""
