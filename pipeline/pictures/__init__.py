"""Pictures of mats: from above, from the side, and in their duct, with axes in micrometers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.pictures.panels import contact_sheet, duct_figure, mat_figure, write_png

__all__ = ["contact_sheet", "duct_figure", "mat_figure", "write_png"]
