"""The sections of the mat, the duct and the mesh."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.analytics.tables.rows import length
from pipeline.line.results import Results
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.fidelity import Fidelity
from pipeline.nouns.mat_measures import DiameterMoments, MatMeasures
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.mesh_measures import MeshingCost, TetmeshMeasures
from pipeline.nouns.section import Charts, Columns, Facts, Picture, Pictures, Section
from pipeline.nouns.surface import Surface
from pipeline.quality.kinds import kinds_in_words
from pipeline.report.page import charts

_SAME = 1e-6  # diameters that differ by less, relatively, are told as one


def mat(content: Results) -> Section | None:
    """Show what the mat is made of."""
    mat, measures, surface = content.get(Mat), content.get(MatMeasures), content.get(Surface)
    if mat is None:
        return None
    facts = [("made by", mat.origin), ("seed", str(mat.seed) if mat.seed >= 0 else "none: nobody drew these fibers")]
    figures = [charts.orientation_histogram(mat)]
    if float(np.ptp(mat.radius)) > _SAME * float(mat.radius.max()):
        figures.insert(0, charts.diameter_histogram(mat))
    if measures is not None:
        d = measures.diameters
        xx, yy, zz = (measures.orientation[k][k] for k in range(3))
        facts += [
            ("fibers", f"{measures.fibers:,} in {measures.segments:,} straight segments"),
            ("summed length", length(measures.total_length)),
            ("coverage", f"{measures.coverage:.4g}, and {measures.covered_fraction:.1%} of the face lies under fibers"),
            ("thickness", f"{length(measures.thickness)}; mean height of the top {length(measures.robust_thickness)}"),
            ("nominal solidity", f"{measures.solidity:.2%} (what fibers share counts twice)"),
            *_diameters(d),
            ("contacts of a fiber", f"{measures.contacts_per_fiber:.3g}"),
            ("orientation tensor, diagonal", f"xx {xx:.3f}, yy {yy:.3f}, zz {zz:.3f}"),
            *_frame(measures.frame_density),
        ]
        figures.append(charts.thickness_profile(measures))
    if surface is not None:
        facts.append(("united surface", f"{len(surface.triangles):,} triangles, solidity {surface.solidity:.2%}"))
    top = Picture("mat-top", "From downstream: x to the right, y up. One color per fiber; twelve colors take turns.")
    side = Picture("mat-side", "From the side: x to the right, the air flows upward.")
    return Section("mat", "Mat", "The mat", (Columns(((top,), (side,))), Facts(tuple(facts)), Charts(tuple(figures))))


def _diameters(d: DiameterMoments) -> list[tuple[str, str]]:
    if d.max - d.min <= _SAME * d.max:
        return [("fiber diameter", f"{length(d.mean)}, all equal")]
    return [
        ("fiber diameter", f"{length(d.mean)} ± {length(d.std)}, from {length(d.min)} to {length(d.max)}"),
        ("mean diameter by surface", length(d.surface_weighted)),
    ]


def _frame(density: float | None) -> list[tuple[str, str]]:
    """Tell how much denser the frame of the plan is than its middle, which the number of a small box carries."""
    if density is None:
        return []
    words = "denser" if density > 1.0 else "less dense"
    told = f"{density:.3g} times: the outer tenth, all around, is {abs(density - 1.0):.0%} {words} than the rest"
    return [("solid per plan area at the frame against the middle", told)]


def duct(content: Results) -> Section | None:
    """Show the duct around the mat."""
    domain = content.get(FluidDomain)
    if domain is None:
        return None
    x, y, z = (1e6 * size for size in domain.box.size)
    before, behind = domain.slab.lower[2] - domain.box.lower[2], domain.box.upper[2] - domain.slab.upper[2]
    facts = (
        ("duct", f"{x:.4g} × {y:.4g} × {z:.4g} µm; air flows along +z"),
        ("plenums", f"{length(before)} before and {length(behind)} behind the mat"),
        ("sides", content.case.enclosure.sides.replace("_", " ")),
        ("air", f"{1e18 * domain.volume:,.0f} µm³"),
        ("face velocity", f"{100 * content.case.flow.face_velocity:.4g} cm/s"),
    )
    return Section("duct", "Duct", "The mat in its duct", (Facts(facts),))


def mesh(content: Results) -> Section | None:
    """Show the cells, and how true their walls are."""
    mesh, made, cost = content.get(FaceMesh), content.get(TetmeshMeasures), content.get(MeshingCost)
    if mesh is None:
        return None
    patches = ", ".join(f"{patch.name} {patch.count:,}" for patch in mesh.patches)
    facts = [("cells", kinds_in_words(mesh)), ("points", f"{len(mesh.points):,}"), ("boundary faces", patches)]
    if made is not None:
        facts += [
            (
                "fiber volume against the surface",
                f"{made.volume_error:+z.2%}; before mending {made.raw_volume_error:+z.2%}",
            ),
            ("air given to the fibers in crevices", f"{made.filled_volume:.3%} of the air"),
            *_walls(made.fidelity),
        ]
    if cost is not None:
        facts.append(("mesher", f"{cost.seconds:.3g} s, at most {cost.peak_memory / 2**20:,.0f} MiB"))
    cut = Picture(
        "cut", "The middle plane x through all cells; the air flows to the right. Holes are fibers, with the walls "
        "behind them.",
    )  # fmt: skip
    views = (
        Picture("close-up", "The same plane around one fiber, five fiber diameters high."),
        Picture("cells", "The whole cells behind that plane, with all fibers."),
        Picture("mesh-fibers", "The mesh's faces on the fibers, one color per fiber."),
    )
    return Section("mesh", "Mesh", "The mesh", (cut, Pictures(views), Facts(tuple(facts))))


def _walls(found: Fidelity | None) -> list[tuple[str, str]]:
    if found is None:
        return []
    errors = np.array(found.radius_error)
    return [
        (
            "walls off the true fibers",
            f"{found.mean_deviation:.3f} diameters on average, 99 % within {found.typical_deviation:.2f}, "
            f"all within {found.largest_deviation:.2f} (where fibers meet)",
        ),
        (
            "radius of single fibers",
            f"{errors.mean():+z.2%} on average, from {errors.min():+z.2%} to {errors.max():+z.2%}",
        ),
    ]
