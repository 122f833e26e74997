"""Text of strangers on a terminal."""

# SPDX-License-Identifier: GPL-3.0-or-later


def printable(text: str) -> str:
    """Replace control characters, with which a stranger's file could steer the terminal that its name is shown on."""
    return "".join(letter if letter.isprintable() or letter == "\n" else "?" for letter in text)
