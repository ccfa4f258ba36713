"""Makes a release of the checked-out commit: writes its version wherever it stands, dates its part of CHANGELOG.md, commits, and tags.

`./dev release VERSION` packs it, too.

Nothing is changed where something is in the way. What it made is a commit and a tag here: to undo it, `git tag -d vVERSION` and
`git reset --hard HEAD~1`; to publish it, push both.
"""
import argparse
import datetime
import re
import subprocess
import sys
from pathlib import Path

SEMVER = r"(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)"
# Where the version stands: a file, and what is before and after it.
PLACES = [("CMakeLists.txt", r"^(project\(Weir VERSION )[0-9.]+()"),
          ("tools/packaging/conda/recipe.yaml", r'^(  version: ")[0-9.]+(")'),
          ("apps/studio/web/package.json", r'^(  "version": ")[0-9.]+(")'),
          ("apps/studio/web/package-lock.json", r'^(  "version": ")[0-9.]+(")'),
          ("apps/studio/web/package-lock.json", r'^(    "": {\n      "name": "weir-studio",\n      "version": ")[0-9.]+(")')]


class Refused(Exception):
    pass


def git(*arguments):
    return subprocess.run(["git", *arguments], check=True, capture_output=True, text=True).stdout.strip()


def numbers(version):
    return tuple(int(part) for part in version.split("."))


def check_version(version):
    if not re.fullmatch(SEMVER, version):
        raise Refused(f"'{version}' is no version: three numbers, as 0.2.0 (https://semver.org)")
    released = [tag[1:] for tag in git("tag", "--list", "v*").split() if re.fullmatch("v" + SEMVER, tag)]
    newest = max(released, key=numbers, default=None)
    if newest and numbers(version) <= numbers(newest):
        raise Refused(f"{version} is not above {newest}, which is released")


def check_clean():
    changed = git("status", "--porcelain")
    if changed:
        raise Refused(f"there are changes that are no part of a commit:\n{changed}")


def dated(changelog, version, date):
    """CHANGELOG.md with the date of this version, and what it says of it."""
    head = f"## [{version}] - unreleased\n"
    start = changelog.find("## [")
    if not changelog.startswith(head, max(start, 0)):
        raise Refused(f"CHANGELOG.md does not begin with '{head.strip()}'")
    end = changelog.find("\n## [", start + 1)
    said = changelog[start + len(head):end if end > 0 else None].strip()
    if not said:
        raise Refused(f"CHANGELOG.md says nothing of {version}")
    return changelog.replace(head, f"## [{version}] - {date}\n", 1), said


def replaced(text, pattern, version, file):
    text, found = re.subn(pattern, rf"\g<1>{version}\g<2>", text, count=1, flags=re.MULTILINE)
    if not found:
        raise Refused(f"{file} has no version where one was: {pattern}")
    return text


def citation(text, version, date):
    text = re.sub(r"^(version|date-released): .*\n", "", text, flags=re.MULTILINE)
    return re.sub(r"^(type: software\n)", rf"\1version: {version}\ndate-released: {date}\n", text, count=1, flags=re.MULTILINE)


def make(version, date):
    check_version(version)
    check_clean()
    texts = {}
    texts["CHANGELOG.md"], said = dated(Path("CHANGELOG.md").read_text(encoding="utf-8"), version, date)
    for file, pattern in PLACES:
        text = texts.get(file) or Path(file).read_text(encoding="utf-8")
        texts[file] = replaced(text, pattern, version, file)
    texts["CITATION.cff"] = citation(Path("CITATION.cff").read_text(encoding="utf-8"), version, date)
    for file, text in texts.items():  # only now, as all of it can be made
        Path(file).write_text(text, encoding="utf-8")
    git("commit", "--quiet", "-m", f"Weir {version}", "--", *texts)
    git("tag", "--annotate", f"v{version}", "-m", f"Weir {version}\n\n{said}", "--cleanup=verbatim")


def main():
    parser = argparse.ArgumentParser(prog="./dev release", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("version", help="such as 1.2.3")
    parser.add_argument("--date", metavar="YYYY-MM-DD", help="of CHANGELOG.md; today, else",
                        default=datetime.date.today().isoformat(), type=lambda text: datetime.date.fromisoformat(text).isoformat())
    arguments = parser.parse_args()
    try:
        make(arguments.version, arguments.date)
    except Refused as reason:
        sys.exit(f"no release was made: {reason}")
    print(f"Made the commit and the tag v{arguments.version}.")


if __name__ == "__main__":
    main()
