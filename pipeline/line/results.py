"""The results of a run: its case, its folder, and the nouns that its finished stages left there."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pipeline.errors import StageError
from pipeline.line import store
from pipeline.line.manifest import read_manifest
from pipeline.line.places import MANIFEST
from pipeline.line.stage import Stage, giver

if TYPE_CHECKING:
    from pipeline.case import Case

Noun = TypeVar("Noun")


@dataclass(frozen=True, eq=False, slots=True)
class Results:
    """What a run has.

    Parameters
    ----------
    case : Case
    folder : Path
        Of the run; each stage has a folder in it.
    line : tuple of Stage
        Who gives which noun.
    left_out : tuple of str
        Stages whose results are there, but of another case or of an earlier state of what they are made from.
    loaded : dict of type to object
        Nouns that were read already.
    made : dict of str to dict
        Manifests that were read already, by stage.
    key : str
        Digest of all that the stage depends on that is being made: what it keeps for a next try is of this key.
    """

    case: "Case"
    folder: Path
    line: tuple[Stage, ...]
    left_out: tuple[str, ...] = ()
    loaded: dict[type, object] = field(default_factory=dict)
    made: dict[str, dict[str, Any]] = field(default_factory=dict)
    key: str = ""

    @property
    def name(self) -> str:
        """Name of the run."""
        return self.folder.resolve().name

    def path(self, noun: type) -> Path:
        """Where a noun is kept."""
        stage = giver(self.line, noun)
        return self.folder / stage.name / stage.gives[noun]

    def read(self, noun: type[Noun]) -> Noun:
        """Read a noun that has to be there.

        Raises
        ------
        StageError
            If it is not there or damaged.
        """
        if noun in self.loaded:
            return self.loaded[noun]  # type: ignore[return-value]
        found = self._from_disk(noun)
        self.loaded[noun] = found
        return found

    def get(self, noun: type[Noun]) -> Noun | None:
        """Read a noun, or give None where the run does not have it."""
        if noun in self.loaded:
            return self.loaded[noun]  # type: ignore[return-value]
        stage = next((stage for stage in self.line if noun in stage.gives), None)
        if stage is None or stage.name in self.left_out or not (self.folder / stage.name / MANIFEST).is_file():
            return None
        return self.read(noun) if self.path(noun).exists() else None

    def _from_disk(self, noun: type[Noun]) -> Noun:
        path = self.path(noun)
        if path.suffix == ".npz":
            return store.load(noun, path)
        if path.suffix == ".json":
            return store.load_json(noun, path)
        if not path.is_dir():
            raise StageError(f"cannot read {path}: there is no such folder; run the stage again with --force")
        return noun(path)  # type: ignore[call-arg]

    def manifest(self, stage: str) -> dict[str, Any] | None:
        """Tell what made a finished stage; None where it is not there or its manifest is damaged."""
        if stage in self.made:
            return self.made[stage]
        return read_manifest(self.folder / stage)

    def manifests(self) -> dict[str, dict[str, Any]]:
        """Tell what made each stage that is there and of this case, in the order of the line."""
        found = {stage.name: self.manifest(stage.name) for stage in self.line if stage.name not in self.left_out}
        return {**self.made, **{name: manifest for name, manifest in found.items() if manifest is not None}}
