"""The file that names all of a run's VTK files, so that one opening shows them."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterable
from xml.sax.saxutils import quoteattr

from pipeline.nouns.patches import PATCHES

INDEX = "mesh.vtm"
VOLUME = "internal.vtu"
BOUNDARY = "boundary"


def format_vtm(patches: Iterable[str], flow: str | None = None) -> str:
    """Index of the files, in the layout of OpenFOAM's `foamToVTK`: `internal`, and `boundary` with a block per patch.

    Parameters
    ----------
    patches : iterable of str
        Names, in any order.
    flow : str, optional
        Where the solved flow lies from here: the block `flow`.

    Examples
    --------
    >>> print(format_vtm(["fibers", "inlet"], "../../solve/flow.vtu"))
    <?xml version="1.0"?>
    <VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">
      <vtkMultiBlockDataSet>
        <DataSet index="0" name="internal" file="internal.vtu"/>
        <Block index="1" name="boundary">
          <DataSet index="0" name="inlet" file="boundary/inlet.vtp"/>
          <DataSet index="1" name="fibers" file="boundary/fibers.vtp"/>
        </Block>
        <DataSet index="2" name="flow" file="../../solve/flow.vtu"/>
      </vtkMultiBlockDataSet>
    </VTKFile>
    <BLANKLINE>
    """
    order = {name: k for k, name in enumerate(PATCHES)}
    names = sorted(patches, key=lambda name: (order.get(name, len(order)), name))
    blocks = "".join(
        f"      <DataSet index={quoteattr(str(k))} name={quoteattr(name)} "
        f"file={quoteattr(f'{BOUNDARY}/{name}.vtp')}/>\n"
        for k, name in enumerate(names)
    )
    last = "" if flow is None else f'    <DataSet index="2" name="flow" file={quoteattr(flow)}/>\n'
    return (
        '<?xml version="1.0"?>\n'
        '<VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">\n'
        "  <vtkMultiBlockDataSet>\n"
        f'    <DataSet index="0" name="internal" file="{VOLUME}"/>\n'
        f'    <Block index="1" name="{BOUNDARY}">\n{blocks}    </Block>\n{last}'
        "  </vtkMultiBlockDataSet>\n</VTKFile>\n"
    )
