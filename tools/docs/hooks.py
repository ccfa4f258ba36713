"""What mkdocs does beside its own: pages of the reference, the C++ interface, and pages of the files that the documents link to.

The environment says where things are: WEIR_PROGRAM, the program that the reference asks, and WEIR_API, the folder that Doxygen
wrote (left out, the site has none, and a link to it is an error).
"""

import logging
import os
import posixpath
import re
import sys
from pathlib import Path

from mkdocs.structure.files import File, InclusionLevel

sys.path.insert(0, str(Path(__file__).parent))
import reference  # noqa: E402  # beside this file, which mkdocs runs from elsewhere

log = logging.getLogger("mkdocs.hooks.weir")
ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"(\]\()(\.\./[^)#\s]+)(#[^)\s]*)?\)")
LANGUAGES = {".h": "cpp", ".cpp": "cpp", ".cu": "cpp", ".inl": "cpp", ".json": "json", ".py": "python", ".sh": "sh", ".txt": "text",
             ".md": "markdown", ".cmake": "cmake"}

made = {}  # pages by path below docs/


def on_config(config):
    made.clear()
    made.update(reference.pages(reference.Program(os.environ["WEIR_PROGRAM"])))
    kinds = {kind: [p for p in made if p.startswith(f"reference/{kind}/")] for kind in ("nodes", "modules")}
    section = ["reference/index.md", {"Scene files": "reference/scene.md"}, {"The command line": "reference/command_line.md"},
               {"Nodes": kinds["nodes"]}, {"Modules": kinds["modules"]}]
    for entry in config.nav:
        if "Reference" in entry:
            entry["Reference"] = section
        if "Engineering notebook" in entry:
            pages = sorted(p.name for p in (ROOT / "engineering").glob("*.md") if p.name != "README.md")
            entry["Engineering notebook"] = [f"engineering/{name}" for name in ["README.md", *pages]]
    add_unnamed_pages(config)
    return config


def add_unnamed_pages(config):
    """Pages that the navigation does not name yet stand at its end, so that none is lost."""
    named = set(re.findall(r"[\w/]+\.md", str(config.nav)))
    unnamed = sorted(p.name for p in Path(config.docs_dir).glob("*.md") if p.name not in named)
    if unnamed:
        config.nav.append({"More": unnamed})


def target_of(page, link):
    """The path in the repository that a link of a page of the site leads to."""
    folder = posixpath.dirname(page) if page.startswith("engineering/") else posixpath.join("docs", posixpath.dirname(page))
    path = posixpath.normpath(posixpath.join(folder, link))
    return None if path.startswith("../") else path


def page_of(path):
    """The page of the site that shows a path of the repository: the notebook has pages of its own, like docs/."""
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return path if path.startswith("engineering/") and path.endswith(".md") else f"files/{path}.md"


def add_notebook(files, config):
    """The engineering notebook, with its pictures."""
    for source in sorted((ROOT / "engineering").rglob("*")):
        if source.suffix in PICTURES | {".md"}:
            path = source.relative_to(ROOT).as_posix()
            files.append(File.generated(config, path, abs_src_path=str(source)))


def on_files(files, config):
    add_notebook(files, config)
    wanted = {path for f in files.documentation_pages() for _, link, _ in LINK.findall(Path(f.abs_src_path).read_text())
              if (path := target_of(f.src_uri, link))}
    for path in sorted(wanted):
        if page_of(path).startswith("files/"):
            add_file_page(path)
    for path, text in made.items():
        # Pages of files are reached by links alone.
        inclusion = InclusionLevel.NOT_IN_NAV if path.startswith("files/") else InclusionLevel.INCLUDED
        files.append(File.generated(config, path, content=text, inclusion=inclusion))
    api = os.environ.get("WEIR_API")
    for source in sorted(Path(api).rglob("*")) if api else []:
        if source.is_file():
            files.append(File.generated(config, "api/" + source.relative_to(api).as_posix(), abs_src_path=str(source)))
    return files


PICTURES = {".jpg", ".png", ".gif", ".webp", ".hdr"}


def add_file_page(path):
    """A page with the text of a file of the repository, or with the list of a folder, whose texts get pages, too."""
    source = ROOT / path
    if source.is_dir():
        inner = sorted(p.relative_to(ROOT).as_posix() for p in source.rglob("*")
                       if p.is_file() and "build" not in p.parts and p.suffix not in PICTURES)
        links = [f"- [{p}]({posixpath.relpath(page_of(p), posixpath.dirname(page_of(path)))})" for p in inner]
        made[page_of(path)] = f"# {path}\n\n" + "\n".join(links) + "\n"
        for p in inner:
            add_file_page(p)
    elif source.is_file():
        language = LANGUAGES.get(source.suffix, "text")
        made[page_of(path)] = f"# {path}\n\n``````{language}\n{source.read_text()}\n``````\n"
    else:
        log.warning("a page links to '%s', which does not exist", path)


def on_page_markdown(markdown, page, **_):
    def replaced(match):
        path = target_of(page.file.src_uri, match[2])
        if path is None or page_of(path).startswith("files/") and page_of(path) not in made:
            return match[0]
        anchor = "" if page_of(path).startswith("files/") else match[3] or ""
        return match[1] + posixpath.relpath(page_of(path), posixpath.dirname(page.file.src_uri) or ".") + anchor + ")"

    return LINK.sub(replaced, markdown)


def on_page_content(html, page, **_):
    """Lists, tables and fences that were not understood stand in the text as they were written."""
    text = re.sub(r"<(pre|code)\b.*?</\1>", "", html, flags=re.DOTALL)
    for found in re.finditer(r"\n(- |\d\. |\|---|```)[^\n]{0,40}", text):
        log.warning("%s: '%s' is not a list, table or block to the site: it needs an empty line before it, and what "
                    "belongs to an item four spaces", page.file.src_uri, found[0].strip())
