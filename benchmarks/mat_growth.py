"""How long mats take: the two sizes of the plan's targets, and the growth with the number of fibers.

    python benchmarks/mat_growth.py [--most 100000] [--plot growth.png]

Times are processor time of one core, compiled code at hand.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import argparse
import time
from pathlib import Path

from pipeline.mat.audit import audit
from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from pipeline.mat.settings import LayeredSettings

FIBERS = {"fiber_diameter": 1.4e-6, "relaxation_slope": 0.15, "seed": 1, "max_fibers": 10**6}


def seconds(contact: str, side: float, stop: dict[str, float]) -> tuple[float, int, int]:
    """Processor time of one mat, its fibers and its segments."""
    asked = FIBERS | {"contact": contact, "side": side, "stop": stop}
    settings = LayeredSettings.model_validate(asked)
    begin = time.process_time()
    mat = generate(settings)
    return time.process_time() - begin, mat.fibers, mat.segments


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=int, default=10_000, help="fibers of the largest mat")
    parser.add_argument("--plot", type=Path, help="picture of the growth")
    options = parser.parse_args()
    for contact in ("paper", "clear"):
        seconds(contact, 10e-6, {"coverage": 1})
        for side in (100e-6, 1e-3):
            best, fibers, segments = min(seconds(contact, side, {"coverage": 4}) for _ in range(3))
            print(f"{contact}, {side * 1e6:g} um: {fibers} fibers, {segments} segments in {best * 1e3:.0f} ms")
    mat = generate(LayeredSettings.model_validate(FIBERS | {"side": 1e-3, "contact": "clear", "stop": {"coverage": 4}}))
    for task in (audit, measure):
        task(mat)
        begin = time.process_time()
        task(mat)
        print(f"{task.__name__} of the last mat: {time.process_time() - begin:.2f} s")

    counts = [count for count in (300, 1000, 3000, 10_000, 30_000, 100_000) if count <= options.most]
    times = {
        contact: [seconds(contact, 1e-3, {"count": count})[0] for count in counts] for contact in ("paper", "clear")
    }
    for contact, taken in times.items():
        print(contact, "1 mm:", ", ".join(f"{n}: {t:.2f} s" for n, t in zip(counts, taken, strict=True)))
    if options.plot is not None:
        draw(counts, times, options.plot)


def draw(counts: list[int], times: dict[str, list[float]], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5, 3.5), layout="constrained")
    axes = figure.subplots()
    for contact, taken in times.items():
        axes.loglog(counts, taken, "o-", label=contact)
    axes.set(xlabel="fibers in a plan of 1 mm x 1 mm", ylabel="processor time / s")
    axes.grid(alpha=0.3)
    axes.legend(title="contact", frameon=False)
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    main()
