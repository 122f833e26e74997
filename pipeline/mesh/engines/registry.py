"""The engines there are: a new one is a room of its own and a line here."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.mesh.engines.ftetwild.engine import TETWILD
from pipeline.mesh.engines.lattice.engine import LATTICE
from pipeline.mesh.engines.snappy.engine import SNAPPY

ENGINES = {engine.name: engine for engine in (TETWILD, LATTICE, SNAPPY)}
"""By the name that a case file has."""

DEFAULT = TETWILD.name
"""The engine of a case that names none."""
