"""Reads what can be checked out of a Markdown page: fenced blocks with their marks, names in back quotes, and links.

A mark is a comment on the line before a block:

    <!-- check: skip, REASON -->          not run; the reason is printed and counted
    <!-- check: with SCENE=a.json -->     words of the block are replaced before it is run or checked; also
                                          frames=N: `weir run` ends after N frames
                                          set=NODE.PARAM=VALUE: `weir run` gets this, to be quick
                                          exit=N: the block shall end with this code
                                          plugin=FILE: a plugin that a scene needs
    <!-- check: file NAME -->             the block is also written to this file, for blocks that follow
    <!-- check: into SCENE at PLACE -->   a piece of JSON, which belongs into that scene at that place (a.b.c), or
                                          without `at` into its outermost object; `file` keeps the whole scene
    <!-- check: from FILE -->             each line of the block stands in that file, in this order
    <!-- check: edit FILE -->             the block takes the place of the last one that was `from` this file, there

Several are separated by semicolons.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

FENCE = re.compile(r"^( *)(`{3,})(\S*)\s*$")
MARK = re.compile(r"^\s*<!-- check: (.*?) -->\s*$")
HEADING = re.compile(r"^#+\s+(.*?)\s*$")


class Mistake(Exception):
    """What is wrong with a page."""


@dataclass
class Mark:
    skip: str = ""
    file: str = ""
    source: str = ""
    edited: str = ""
    scene: str = ""
    place: str = ""
    exit: int = 0
    frames: int | None = None
    plugin: str = ""
    settings: list = field(default_factory=list)
    words: dict = field(default_factory=dict)


@dataclass
class Block:
    line: int
    language: str
    text: str
    mark: Mark


@dataclass
class Page:
    name: str
    blocks: list
    codes: list  # (line, text) of names in back quotes
    links: list  # (line, target)
    anchors: set


def read_mark(text):
    mark = Mark()
    for part in re.split(r";\s*(?=(?:skip,|with|file|into|from|edit) )", text):
        kind, _, rest = part.strip().partition(" ")
        if kind == "skip,":
            mark.skip = rest
        elif kind == "file":
            mark.file = rest
        elif kind == "from":
            mark.source = rest
        elif kind == "edit":
            mark.edited = rest
        elif kind == "into":
            mark.scene, _, mark.place = rest.partition(" at ")
        elif kind == "with":
            read_words(mark, rest)
        else:
            raise Mistake(f"the mark '{part.strip()}' is not understood")
    return mark


def read_words(mark, text):
    for word in text.split():
        name, equals, value = word.partition("=")
        if not equals:
            raise Mistake(f"'{word}' of the mark is no NAME=VALUE")
        if name in ("exit", "frames"):
            setattr(mark, name, int(value))
        elif name == "set":
            mark.settings.append(value)
        elif name == "plugin":
            mark.plugin = value
        else:
            mark.words[name] = value


def anchor(heading):
    """The name that a heading has in links."""
    plain = re.sub(r"[`*]|\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", plain.lower()).strip().replace(" ", "-")


def read_page(path, name):
    lines = Path(path).read_text().split("\n")
    page = Page(name, [], [], [], set())
    i = 0
    while i < len(lines):
        fence = FENCE.match(lines[i])
        if fence is None:
            read_prose(page, i + 1, lines[i])
            i += 1
            continue
        end = next((j for j in range(i + 1, len(lines)) if lines[j].strip() == fence[2]), None)
        if end is None:
            raise Mistake(f"{name}:{i + 1}: the block does not end")
        marked = MARK.match(lines[i - 1]) if i > 0 else None
        text = "\n".join(line.removeprefix(fence[1]) for line in lines[i + 1:end]) + "\n"
        try:
            mark = read_mark(marked[1]) if marked else Mark()
        except Mistake as mistake:
            raise Mistake(f"{name}:{i}: {mistake}") from None
        page.blocks.append(Block(i + 1, fence[3], text, mark))
        i = end + 1
    return page


def read_prose(page, number, line):
    page.codes += [(number, code) for code in re.findall(r"`([^`]+)`", line)]
    page.links += [(number, target) for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", line))]
    if heading := HEADING.match(line):
        page.anchors.add(anchor(heading[1]))
