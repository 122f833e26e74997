"""What the formulas of this room take and give: plain numbers or arrays of them."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TypeAlias, TypeVar

from pipeline.nouns.arrays import Floats

Numbers: TypeAlias = float | Floats
"""A number or an array; several of them broadcast against each other as numpy does."""

Real = TypeVar("Real", float, Floats)
"""A number in, a number out; an array in, an array out."""
