"""Packages that some functions use, and nobody else has to install."""

from __future__ import annotations

import importlib
from typing import Any

from ._errors import Error


def imported(package: str, name: str) -> Any:
    """The package, or an Error that tells how to get it. `name` is what people call it."""
    try:
        return importlib.import_module(package)
    except ImportError as reason:
        what, hint = f"{name} cannot be imported: {reason}", f"pip install {package}"
        raise Error(f"{what}\n  hint: {hint}", "usage", "", what, "", hint) from None
