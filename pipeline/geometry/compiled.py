"""Loops compiled by numba, once per machine."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numpy as np
import numpy.typing as npt
from numba import njit

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")
_Scalar = TypeVar("_Scalar", bound=np.generic)


def compiled(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """Compile a function when it is first called, and keep the machine code on disk.

    The same as numba's ``njit(cache=True)``, but the function keeps its types for mypy.
    """
    machine_code: Callable[_Arguments, _Result] = njit(cache=True)(function)
    return machine_code


def compiled_for_threads(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """Compile like `compiled`, and let other threads run meanwhile: the function touches no Python object."""
    machine_code: Callable[_Arguments, _Result] = njit(cache=True, nogil=True)(function)
    return machine_code


def read_only(array: npt.NDArray[_Scalar]) -> npt.NDArray[_Scalar]:
    """Give a view that cannot be written, in one block: a loop is compiled anew for arrays of every other make."""
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view
