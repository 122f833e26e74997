"""Feeds for the mesher, side by side: corners, rings, joints, cleared splinters.

python benchmarks/surface.py              the surfaces alone, a corner of Fig. 10 and the whole mat
python benchmarks/surface.py --mesh 2     also fTetWild's CPU seconds, cells and volume error after 2 passes
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import argparse
import math
import resource
import time

import numpy as np

from pipeline.child_process import Limits
from pipeline.enclosure.duct import enclose
from pipeline.enclosure.settings import EnclosureSettings
from pipeline.geometry.tets import volumes
from pipeline.mat.generate import generate
from pipeline.mat.settings import Constant, LayeredSettings, Stop
from pipeline.mesh.engines.ftetwild.running import run_mesher
from pipeline.surface.measures import measure_surface
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite

DIAMETER = 1.4e-6
ENVELOPE, EDGE = 0.04, 0.6

FEEDS = [
    {"sides": 10, "ring_spacing": 0.6},
    {"sides": 10, "ring_spacing": 0.6, "smallest_edge": 0.0},
    {"sides": 10, "ring_spacing": 0.6, "joint": "sphere"},
    {"sides": 10, "ring_spacing": 0.6, "joint": "sphere", "smallest_edge": 0.0},
    {"sides": 8, "ring_spacing": 0.6},
    {"sides": 12, "ring_spacing": 0.5},
    {"sides": 12, "ring_spacing": 0.5, "smallest_edge": 0.0},
    {"sides": 16, "ring_spacing": 0.5},
    {"sides": 12, "ring_spacing": 5.0, "smallest_edge": 0.0},
]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mesh", type=int, default=0, metavar="PASSES")
    parser.add_argument("--count", type=int, default=18, help="fibers in the 20 um corner")
    parser.add_argument("--whole", action="store_true", help="also the whole mat of Fig. 10 (100 um)")
    options = parser.parse_args()
    base = {"fiber_diameter": Constant(diameter=DIAMETER), "relaxation_slope": 0.15}
    corner = generate(LayeredSettings(side=2e-5, stop=Stop(count=options.count), **base))
    print(f"{corner.fibers} fibers, {corner.segments} segments")
    for feed in FEEDS:
        report(corner, SurfaceSettings(**feed), options.mesh)
    if options.whole:
        mat = generate(LayeredSettings(side=1e-4, stop=Stop(coverage=4), **base))
        print(f"{mat.fibers} fibers, {mat.segments} segments")
        report(mat, SurfaceSettings(), 0)


def report(mat, settings: SurfaceSettings, passes: int) -> None:
    began = time.process_time()
    surface = unite(mat, settings)
    united = time.process_time() - began
    domain = enclose(surface, EnclosureSettings(inlet=6e-6, outlet=6e-6))
    enclosed = time.process_time() - began - united
    measures = measure_surface(mat, surface, settings)
    cylinders = math.pi * float((mat.radius[mat.segment_fibers()] ** 2 * mat.segment_lengths()).sum())
    line = (
        f"n {settings.sides} rings {settings.ring_spacing} {settings.joint} clear {settings.smallest_edge}: "
        f"{measures.triangles} triangles, {measures.splinters} splinters, "
        f"{measures.self_intersections} self-intersections, volume {surface.volume / cylinders:.5f} of the cylinders, "
        f"overlap {measures.overlap_volume / cylinders:.5f}, unite {united:.2f} s, enclose {enclosed:.2f} s"
    )
    if passes:
        line += f"; {mesh(domain, passes)}"
    print(line, flush=True)


def mesh(domain, passes: int) -> str:
    points = domain.points / DIAMETER
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    options = {"edge_length_abs": EDGE, "epsilon": ENVELOPE / diagonal, "stop_energy": 10.0, "num_opt_iter": passes}
    options |= {"num_threads": 1, "vtk_ordering": True, "quiet": False, "loglevel": 3}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    raw = run_mesher(points, domain.triangles, options, {}, Limits(3600.0, 16e9), lambda what, done=None: None)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    air = float(volumes(raw.points * DIAMETER, raw.tets).sum())
    error = (domain.volume - air) / (domain.box.volume - domain.volume)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return f"fTetWild {cpu:.1f} s CPU, {len(raw.tets)} cells, fiber volume {error:+.2%}"


if __name__ == "__main__":
    main()
