"""What scenes are built from: Weir's own types and those of plugins."""

from __future__ import annotations

import logging
import os
from pathlib import Path

from . import _core
from ._errors import Error


def _folders() -> list[Path]:
    named = os.environ.get("WEIR_PLUGIN_PATH", "").split(":")
    return [Path(folder) for folder in named if folder] + [Path(_core.own_plugin_folder())]


def _make() -> _core.Library:
    made = _core.Library()
    for folder in _folders():
        for file in sorted(folder.glob("*.so")):
            try:
                made.load_plugin(str(file))
            except Error as error:
                logging.getLogger("weir").warning("going on without a plugin: %s", error)
    return made


library = _make()


def load_plugin(file: str | os.PathLike) -> None:
    """Load a plugin's shared library. Its nodes and modules can be used in scenes from then on."""
    library.load_plugin(os.fspath(file))


def plugins() -> list[str]:
    """Files of the plugins that are loaded."""
    return library.plugins


def version() -> str:
    """Weir's version."""
    return _core.version()


def devices() -> list[tuple[str, str]]:
    """Names and descriptions of the devices of this machine that simulations can run on."""
    return _core.devices()


def schema() -> str:
    """JSON Schema of scene files, for everything that is loaded."""
    return library.schema()
