"""Random center lines that run into themselves: coils, knots, hairpins, walks."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.nouns.arrays import Floats


def tangle(kind: str, rng: np.random.Generator) -> Floats:
    """One center line about the middle of a cube of 10 um, for a fiber of 0.7 um radius, (n, 3) array [um]."""
    line = {"coil": _coil, "knot": _knot, "hairpin": _hairpin, "walk": _walk, "there and back": _there_and_back}[kind](
        rng
    )
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    line = (line - line.mean(axis=0)) @ turn.T
    placed: Floats = 5.0 + line * min(1.0, 4.0 / float(np.abs(line).max()))
    return placed


def _coil(rng: np.random.Generator) -> Floats:
    # whole turns without a pitch cover themselves, with a small one they cut themselves
    turns, pitch = rng.integers(1, 4) + rng.choice([0.0, 0.3]), rng.choice([0.0, 0.3, 1.0, 2.0])
    angle = np.linspace(0, 2 * np.pi * turns, int(turns * rng.integers(12, 30)) + 1)
    return np.stack([2.5 * np.cos(angle), 2.5 * np.sin(angle), pitch * angle / (2 * np.pi)], axis=1)


def _knot(rng: np.random.Generator) -> Floats:
    angle = np.linspace(0, 2 * np.pi, rng.integers(40, 90))
    p, q = rng.choice([2, 3, 4]), rng.choice([3, 5, 1])
    around = 2.2 + rng.uniform(0.4, 1.2) * np.cos(q * angle)
    return np.stack([around * np.cos(p * angle), around * np.sin(p * angle), 0.8 * np.sin(q * angle)], axis=1)


def _hairpin(rng: np.random.Generator) -> Floats:
    # a bend wide enough for miters, whose legs lean toward each other
    radius, lean = rng.uniform(0.75, 1.1), rng.uniform(0.0, 0.5)
    angle = np.linspace(-0.5 * np.pi - lean, 0.5 * np.pi + lean, rng.integers(8, 20))
    bend = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    legs = [bend[k] + rng.uniform(3, 6) * np.array([-np.cos(lean), -s * np.sin(lean)]) for k, s in ((0, -1), (-1, 1))]
    flat = np.concatenate([[legs[0]], bend, [legs[1]]])
    return np.column_stack([flat, rng.choice([0.0, 0.05]) * np.arange(len(flat))])


def _walk(rng: np.random.Generator) -> Floats:
    # steps of half a radius to four, turning by any angle
    steps = rng.normal(size=(rng.integers(3, 25), 3))
    steps *= rng.uniform(0.35, 2.8, (len(steps), 1)) / np.linalg.norm(steps, axis=1)[:, None]
    return np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def _there_and_back(rng: np.random.Generator) -> Floats:
    there = np.cumsum(rng.uniform(0.5, 2.0, (rng.integers(2, 6), 3)), axis=0)
    return np.concatenate([there, there[-2::-1]])


KINDS = {"coil": _coil, "knot": _knot, "hairpin": _hairpin, "walk": _walk, "there and back": _there_and_back}
