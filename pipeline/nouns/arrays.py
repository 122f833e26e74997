"""What the nouns are made of: read-only arrays, checked once."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TypeVar

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]
_Scalar = TypeVar("_Scalar", bound=np.generic)


def frozen(array: npt.NDArray[_Scalar]) -> npt.NDArray[_Scalar]:
    """Give a read-only array with this content."""
    copy = np.ascontiguousarray(array)
    if copy is array and array.flags.writeable:
        copy = array.copy()
    copy.flags.writeable = False
    return copy


def freeze(thing: object, **arrays: npt.NDArray[np.generic]) -> None:
    """Fill a frozen dataclass from its own ``__post_init__``."""
    for name, array in arrays.items():
        object.__setattr__(thing, name, frozen(array))


def require(holds: bool, message: str) -> None:
    """Refuse to make a thing that is not valid.

    Raises
    ------
    ValueError
    """
    if not holds:
        raise ValueError(message)


def all_within(numbers: Ints, count: int) -> bool:
    """Whether every number is an index into so many things."""
    return numbers.size == 0 or (int(numbers.min()) >= 0 and int(numbers.max()) < count)
