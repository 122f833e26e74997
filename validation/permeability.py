"""The permeability of layered random mats: from studies to data, tables, fits, and a plot beside models.

``python -m validation.permeability RUNS`` carries out ``cases/studies/permeability*.toml`` in folders of RUNS, seed
after seed of all of them, so that whatever is finished is balanced; goes on where it was interrupted; and writes
docs/data/permeability*.csv, the tables of docs/permeability.md and its plot after every seed. Without RUNS it makes
tables and plot of the data that are there.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from functools import partial
from pathlib import Path

from pipeline.study.settings import Study, read_study
from pipeline.study.study import carry_out_study
from validation.permeability_data import DATA, SLIP_DATA, SLIP_SEEDS, STUDIES, measured, slipping, sweep_slip
from validation.permeability_page import FEWEST, write_page
from validation.records import write_records


def one_seed(study: Study, number: int, keep: bool) -> Study:
    """Give the part of a study that is of its `number`-th seed."""
    changed = {"first_seed": study.first_seed + number, "seeds": 1, "keep": "everything" if keep else "numbers"}
    return study.model_copy(update=changed)


def main(folder: Path) -> None:
    """Carry the studies out, and write data, page and plot after every seed."""
    tell = partial(print, flush=True)
    studies = {path.stem: read_study(path) for path in STUDIES}
    for number in range(max(study.seeds for study in studies.values())):
        for name, study in studies.items():
            if number >= study.seeds:
                continue
            swept = name == STUDIES[0].stem and number < SLIP_SEEDS
            result = carry_out_study(one_seed(study, number, swept), folder / name, workers=1)
            tell(f"{name}, seed {study.first_seed + number}: {result.made} made, {result.reused} kept")
            for point in result.points:
                for run in point.runs:
                    if run.error:
                        tell(f"{name}, {point.settings}, seed {run.seed}: {run.error}")
            if swept:
                sweep_slip(folder / name, tell)
        mats = [each for name in studies for each in measured(folder / name)]
        write_records(DATA, mats)
        write_records(SLIP_DATA, list(slipping(folder / STUDIES[0].stem)))
        if len(mats) >= FEWEST:
            write_page()


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        write_page()
