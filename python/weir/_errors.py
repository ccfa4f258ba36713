"""The exception that everything in Weir raises for a user's mistake."""

from __future__ import annotations


class Error(Exception):
    """What was wrong, where, and what would have been right. Its text is that of the program `weir`."""

    kind: str
    """ "usage", "scene", "simulation" or "io"."""
    where: str
    """The place as the text names it, such as "node 'water': parameter 'spacing'"; may be empty."""
    found: str
    """What was found."""
    allowed: str
    """What is allowed; may be empty."""
    hint: str
    """What may help; may be empty."""
    file: str
    line: int
    column: int
    pointer: str
    """JSON pointer into the scene."""
    node: str
    parameter: str
    part: str
    """Of a plugin: "module 'lift' (plugin lift)"."""

    def __init__(self, text: str, kind: str = "usage", where: str = "", found: str = "", allowed: str = "",
                 hint: str = "", place: dict | None = None):
        super().__init__(text, kind, where, found, allowed, hint, place)
        self.kind, self.where, self.found, self.allowed, self.hint = kind, where, found or text, allowed, hint
        place = place or {}
        self.file, self.line, self.column = place.get("file", ""), place.get("line", 0), place.get("column", 0)
        self.pointer, self.node = place.get("pointer", ""), place.get("node", "")
        self.parameter, self.part = place.get("parameter", ""), place.get("part", "")

    def __str__(self) -> str:
        return self.args[0]


def usage_error(found: str, allowed: str, where: str = "") -> Error:
    """The error of a call that cannot be understood."""
    return Error((where and f"{where}: ") + f"{found}\n  allowed: {allowed}", "usage", where, found, allowed)
