#!/usr/bin/env python3
"""Checks what the documentation says: runs its commands, validates its scenes, and looks up its code, paths and links.

Each page has a folder of its own below out/check_docs, which holds links to what the repository has, so commands find scenes and
leave nothing behind. What is not run says why; documents.py tells how a page says so. Of the engineering notebook and of the files beside
README.md only links are followed: their commands are those of their day. Ends with 1 if anything is wrong.
"""

import argparse
import ast
import json
import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import commands  # noqa: E402
import documents  # noqa: E402
import measured  # noqa: E402
import prose  # noqa: E402
from documents import Mistake  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("framework", "nodes", "plugins", "apps", "tests", "tools", "examples", "resources", "cmake", "docs", "engineering")
LONGEST = 600  # seconds that one block may take
LANGUAGES = {"sh", "json", "jsonc", "cpp", "python", "cmake", "text"}


def has_gpu():
    return Path("/dev/nvidiactl").exists() or Path("/dev/dxg").exists()


def without_comments(text):
    """JSON of JSON with // comments, which do not occur in strings here."""
    return re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*', lambda m: m[1] or "", text)


def with_options(text, options):
    """A script whose `weir run` get more options, before their comments."""
    return re.sub(r"(?m)^((?:\S*/)?weir run(?:\\\n|[^#\n])*?)(\s*(?:#.*)?)$", rf"\1 {options}\2", text)


def merged(into, piece):
    if isinstance(into, dict) and isinstance(piece, dict):
        return {**into, **{k: merged(into.get(k), v) for k, v in piece.items()}}
    return piece


class PageCheck:
    """One page: what was done with it, and what is wrong."""

    def __init__(self, path, name, build, folder, links_only=False):
        self.path, self.name, self.build, self.folder, self.links_only = path, name, build, folder, links_only
        self.checker = commands.Checker(ROOT, build)
        self.mistakes, self.skipped = [], []
        self.compared = {}  # the last block that was compared with a file, by its name
        self.counts = {"run": 0, "checked": 0, "scenes": 0, "compared": 0, "names": 0}
        self.seconds = 0.0

    def run(self):
        start = time.monotonic()
        try:
            page = documents.read_page(self.path, self.name)
        except Mistake as mistake:
            self.mistakes.append(str(mistake))
            return self
        if not self.links_only:
            self.prepare()
            self.check_text()
            for block in page.blocks:
                self.guarded(block.line, lambda block=block: self.check_block(block))
            for line, code in page.codes:
                self.guarded(line, lambda code=code: self.check_code(code))
        for line, target in page.links:
            self.guarded(line, lambda target=target: self.check_link(target, page))
        self.seconds = time.monotonic() - start
        return self

    def check_text(self):
        """Pages for users have no history."""
        for line in prose.lines_with_hashes(self.path.read_text()):
            self.mistakes.append(f"{self.name}:{line}: a commit hash belongs into engineering/")

    def guarded(self, line, check):
        try:
            check()
        except Mistake as mistake:
            self.mistakes.append(f"{self.name}:{line}: {mistake}")

    def prepare(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        for entry in ROOT.iterdir():
            if entry.name not in ("out", ".git"):
                (self.folder / entry.name).symlink_to(entry)
        (self.folder / "home").mkdir()

    def skip(self, line, reason):
        self.skipped.append((line, reason))

    def check_block(self, block):
        if block.language not in LANGUAGES:
            raise Mistake(f"the block says '{block.language}': allowed are {', '.join(sorted(LANGUAGES))}")
        text = block.text
        for word, value in block.mark.words.items():
            if not re.search(rf"\b{re.escape(word)}\b", text):
                raise Mistake(f"the mark replaces {word}, which the block does not have")
            text = re.sub(rf"\b{re.escape(word)}\b", value, text)
        if block.mark.source:
            self.compare(block.mark.source, text)
        elif block.mark.edited:
            self.edit(block.mark.edited, text)
        elif block.mark.skip and block.language != "sh":
            self.skip(block.line, block.mark.skip)
        elif block.language == "sh":
            self.check_script(block, text)
        elif block.language in ("json", "jsonc"):
            self.check_json(block, text)
        elif block.language == "python":
            self.check_python(block, text)
        elif block.language != "text":
            raise Mistake(f"{block.language} needs a mark that says where it is from")
        if block.mark.file and not block.mark.scene:
            target = self.folder / block.mark.file
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text)

    def compare(self, source, text):
        """Each line stands in the file, in this order; `…` stands for anything."""
        file = next((f for f in (self.folder / source, ROOT / source) if f.is_file()), None)
        if file is None:
            raise Mistake(f"there is no file {source} to compare with")
        lines = [" ".join(line.split()) for line in file.read_text().split("\n")]
        at = 0
        for line in text.split("\n"):
            wanted = " ".join(line.split())
            if not wanted or wanted == "…":
                continue
            pattern = ".*".join(re.escape(part) for part in wanted.split("…"))
            found = next((i for i in range(at, len(lines)) if re.fullmatch(pattern, lines[i])), None)
            if found is None:
                raise Mistake(f"{source} has no line '{wanted}' there")
            at = found + 1
        self.counts["compared"] += 1
        self.compared[source] = text

    def edit(self, name, text):
        file, old = self.folder / name, self.compared.get(name)
        if old is None or not file.is_file():
            raise Mistake(f"no block before it was compared with {name}, a file that the page's commands made")
        whole = file.read_text()
        if whole.count(old) != 1:
            raise Mistake(f"{name} does not hold the block before it, as it stands, once")
        file.write_text(whole.replace(old, text))
        self.counts["compared"] += 1

    def environment(self):
        home = self.folder / "home"
        kept = {k: v for k, v in os.environ.items() if not k.startswith(("WEIR_", "CMAKE_PREFIX"))}
        kept.update(HOME=str(home), PATH=f"{self.build / 'bin'}:{os.environ['PATH']}", PYTHONDONTWRITEBYTECODE="1")
        if (self.build / "python").is_dir():
            kept["PYTHONPATH"] = str(self.build / "python")  # the package weir, where the build has made it
        if shutil.which("ccache"):
            kept.update(CMAKE_CXX_COMPILER_LAUNCHER="ccache", CMAKE_CUDA_COMPILER_LAUNCHER="ccache",
                        CCACHE_BASEDIR=str(self.folder), CCACHE_NOHASHDIR="1",
                        CCACHE_DIR=os.environ.get("CCACHE_DIR", str(Path.home() / ".cache/ccache")))
        return kept

    def execute(self, command, line, code=0):
        try:
            done = subprocess.run(command, cwd=self.folder, env=self.environment(), capture_output=True, text=True,
                                  check=False, timeout=LONGEST, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            raise Mistake(f"the block of line {line} takes longer than {LONGEST} s") from None
        if done.returncode != code:
            tail = "\n".join((done.stdout + done.stderr).strip().split("\n")[-12:])
            raise Mistake(f"ended with {done.returncode}, not {code}:\n{tail}")

    def check_script(self, block, text):
        if block.mark.frames is not None:
            text = with_options(text, f"--frames {block.mark.frames}")
        for setting in block.mark.settings:
            text = with_options(text, f"--set {setting}")
        needs_gpu = not has_gpu() and re.search(r"--device cuda|build/cuda/|preset cuda", text)
        reason = block.mark.skip or ("it needs a GPU" if needs_gpu else "")
        found = commands.split(text)
        if reason:
            self.skip(block.line, reason)
            for words in found:
                self.checker.check(words, self.folder)
                self.counts["checked"] += 1
        else:
            failing = 'trap \'echo "the command that failed: $BASH_COMMAND" >&2\' ERR; '
            self.execute(["bash", "-euo", "pipefail", "-c", failing + "\n" + text], block.line, block.mark.exit)
            self.counts["run"] += len(found)

    def check_json(self, block, text):
        """A whole scene is validated as it stands, so comments are right where the program reads them."""
        mark = block.mark
        whole_with_comments = block.language == "jsonc" and not mark.scene  # which only the program can read
        try:
            value = {"weir": 1} if whole_with_comments else self.parsed(
                without_comments(text) if block.language == "jsonc" else text, bool(mark.scene))
        except ValueError as error:
            raise Mistake(f"this is no JSON: {error}") from None
        target = self.folder / (mark.file or "checked_scene.json")
        if mark.scene:
            base = next((f for f in (self.folder / mark.scene, ROOT / mark.scene) if f.is_file()), None)
            if base is None:
                raise Mistake(f"there is no scene {mark.scene}")
            scene = json.loads(without_comments(base.read_text()))
            keys = [key for key in mark.place.split(".") if key]
            for key in reversed(keys):
                value = {key: value}
            value = merged(scene, value)
        elif not isinstance(value, dict) or "weir" not in value:
            raise Mistake("a piece of a scene needs a mark that says into which scene it belongs")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(json.dumps(value, ensure_ascii=False, indent=2) if mark.scene else text)
        plugin = ["--plugin", mark.plugin] if mark.plugin else []
        self.execute([str(self.build / "bin/weir"), "validate", str(target), *plugin], 0, mark.exit)
        self.counts["scenes"] += 1

    @staticmethod
    def parsed(text, is_piece):
        text = text.strip().removesuffix(",")
        return json.loads("{" + text + "}" if is_piece and not text.startswith("{") else text)

    def check_python(self, block, text):
        missing = self.missing_modules(text)
        if missing:
            self.skip(block.line, f"Python has no {', '.join(missing)} here; its syntax was checked")
            return
        self.execute([sys.executable, "-c", text], block.line, block.mark.exit)
        self.counts["run"] += 1

    def missing_modules(self, text):
        """The modules that the code imports and that this Python does not have."""
        try:
            tree = ast.parse(text)
        except SyntaxError as error:
            raise Mistake(f"this is no Python: {error}") from None
        names = [a.name for node in ast.walk(tree) if isinstance(node, ast.Import) for a in node.names]
        names += [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        tops = sorted({name.split(".")[0] for name in names})
        return [top for top in tops if subprocess.run(
            [sys.executable, "-c", f"import {top}"], capture_output=True, check=False, cwd=self.folder, env=self.environment()).returncode != 0]

    def check_code(self, code):
        """A name in back quotes: a path of the repository, or a command."""
        path = re.fullmatch(r"[\w./-]+/[\w./-]*\w", code)
        if path and code.split("/")[0] in ROOMS:
            if not (ROOT / code).exists():
                raise Mistake(f"there is no {code}")
            self.counts["names"] += 1
        elif re.match(r"(weir|\./dev|weir_\w+_tests) ", code) and not re.search(r"\b[A-Z]{3,}\b|…", code):
            for words in commands.split(code):
                self.checker.check(words, ROOT)
                self.counts["checked"] += 1

    def check_link(self, target, page):
        """Links of pages of docs/ are the site's affair, too, which knows anchors as it makes them."""
        path, _, name = target.partition("#")
        if re.match(r"[a-z]+:", target):
            return
        self.counts["names"] += 1
        if path in ("reference/index.md", "api/index.html") or path.startswith("reference/"):
            return  # made with the site
        file = (self.path.parent / path) if path else self.path
        if not file.exists():
            raise Mistake(f"the link to {target} leads nowhere")
        anchors = page.anchors if not path else None
        if name and file.suffix == ".md":
            anchors = anchors if anchors is not None else documents.read_page(file, path).anchors
            if name not in anchors:
                raise Mistake(f"the link to {target} leads to no heading; there are: {', '.join(sorted(anchors))}")


def is_for_users(page):
    return page.parent.name == "docs" or page.name == "README.md" and page.parent == ROOT


def pages_of(names):
    found = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    found += [*sorted((ROOT / "engineering").glob("*.md")), *sorted(p for p in ROOT.glob("*.md") if p not in found)]
    if not names:
        return found
    wanted = [p for p in found if is_for_users(p) and (p.stem in names or p.name in names)]
    unknown = set(names) - {p.stem for p in wanted} - {p.name for p in wanted}
    if unknown:
        raise SystemExit(f"check: there is no page {', '.join(sorted(unknown))}")
    return wanted


def mistakes_of_all():
    """What is wrong with the pages together."""
    words = sum(prose.words(page.read_text()) for page in (ROOT / "docs").glob("*.md"))
    if words > prose.MAX_WORDS:
        yield f"docs/ has {words:,} words, at most {prose.MAX_WORDS:,} are allowed: tools/docs/prose.py tells them by page"
    for name in measured.stale(write=False):
        yield f"{name} has other numbers than those measured: run tools/docs/measured.py"


def report(checks, others=()):
    for c in checks:
        done = ", ".join(f"{number} {what}" for what, number in c.counts.items() if number)
        print(f"{c.name}: {done or 'nothing to check'}; {len(c.skipped)} not run; {c.seconds:.0f} s")
        for line, reason in c.skipped:
            print(f"    line {line} is not run: {reason}")
    total = {k: sum(c.counts[k] for c in checks) for k in checks[0].counts}
    print(f"{total['run']} commands run, {total['checked']} commands looked up, {total['scenes']} scenes validated, "
          f"{total['compared']} pieces of code compared, {total['names']} paths and links followed, "
          f"{sum(len(c.skipped) for c in checks)} blocks not run.")
    mistakes = [*(m for c in checks for m in c.mistakes), *others]
    for mistake in mistakes:
        print(f"MISTAKE {mistake}", file=sys.stderr)
    return 1 if mistakes else 0


def main():
    parser = argparse.ArgumentParser(prog="./dev check-docs", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--build", type=Path, required=True, metavar="DIR", help="the build whose program is used")
    parser.add_argument("--only", default="", metavar="PAGES", help="some pages, such as README,extending")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 2, metavar="N", help="pages at a time")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "check_docs", metavar="DIR", help="where commands run")
    chosen = parser.parse_args()
    build = chosen.build.resolve()
    pages = pages_of([name.strip() for name in chosen.only.split(",") if name.strip()])
    with ThreadPoolExecutor(chosen.jobs) as pool:
        jobs = [pool.submit(PageCheck(p, p.relative_to(ROOT).as_posix(), build, chosen.out.resolve() / p.stem, not is_for_users(p)).run)
                for p in pages]
        code = report([job.result() for job in jobs], () if chosen.only else list(mistakes_of_all()))
    return code


if __name__ == "__main__":
    sys.exit(main())
