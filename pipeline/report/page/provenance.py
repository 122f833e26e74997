"""What the results of a run were made from."""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib.metadata
import platform
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from pipeline.line import store
from pipeline.line.results import Results


def provenance(content: Results) -> dict[str, Any]:
    """Give what the results were made from, and every setting."""
    stages = [
        {
            "name": name,
            "seconds": f"{manifest['seconds']:.3g}",
            "memory": f"{manifest['peak_memory'] / 2**20:,.0f}" if "peak_memory" in manifest else "",
            "key": str(manifest["key"]),
            "code": store.digest(manifest["code"]),
            "libraries": ", ".join(f"{library} {version}" for library, version in manifest["libraries"].items()),
            "files": {**manifest["files"], **manifest["records"]},
        }
        for name, manifest in content.manifests().items()
    ]
    return {
        "settings": list(settings_rows(content.case)),
        "stages": stages,
        "versions": versions(),
    }


def versions() -> str:
    """Say which program on what machine made a page."""
    return (
        f"fibertwin {importlib.metadata.version('fibertwin')}, Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}"
    )


def settings_rows(settings: BaseModel, path: str = "") -> Iterator[tuple[str, str, str]]:
    """Give every setting: its path in the case file, its value in SI, and what it is."""
    for name, about in type(settings).model_fields.items():
        value = getattr(settings, name)
        if isinstance(value, BaseModel):
            yield from settings_rows(value, f"{path}{name}.")
        elif value is not None:
            text = ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)
            yield f"{path}{name}", text, about.description or ""
