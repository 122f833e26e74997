"""How a mesh is split for the processes that share it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.openfoam.foam_file import format_dictionary


def format_decompose(cores: int) -> str:
    """`system/decomposeParDict`: slices across the flow, cut by a method that every build has.

    Examples
    --------
    >>> "numberOfSubdomains 4;" in format_decompose(4) and "n       (1 1 4);" in format_decompose(4)
    True
    """
    return format_dictionary(
        "decomposeParDict",
        "system",
        f"""
numberOfSubdomains {cores};
method          hierarchical;
hierarchicalCoeffs
{{
    n       (1 1 {cores});
    delta   0.001;
    order   xyz;
}}
""",
    )
