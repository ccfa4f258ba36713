"""Writes the list of what a package of Weir holds from elsewhere, with versions and licences: an SBOM, as SPDX 2.3 in JSON.

usage: make_sbom.py PREFIX SOURCE          PREFIX: an installation; SOURCE: the sources that it was built from

It becomes PREFIX/share/doc/weir/weir.spdx.json. Shared libraries are those that ldd finds for programs and libraries of
PREFIX: those that stand in it are a part of the package, others it depends on. Versions and licences are those of the
Debian packages that they are from: the licence of `Files: *` in the package's copyright file; the licences of all files
are named in a comment. Where that file is not in the usual form, the licence is NOASSERTION. Of libraries that are headers,
and of the packages in the studio's page, there are the lists below and package-lock.json.

Two builds from the same packages give the same file, as SOURCE_DATE_EPOCH is its time, or else that of the installed program.
"""

import functools
import hashlib
import importlib.metadata
import json
import os
import re
import subprocess
import sys
from datetime import datetime, timezone
from pathlib import Path

# What is compiled in. Those that are not installed were not there for the build either.
COMPILED_IN = ("nlohmann-json3-dev", "libcli11-dev", "libeigen3-dev", "libboost1.74-dev", "libboost1.83-dev", "libstb-dev",
               "libspdlog-dev", "fonts-dejavu-core")
SPDX_NAMES = {"expat": "MIT", "mit": "MIT", "bsd-2-clause": "BSD-2-Clause", "bsd-3-clause": "BSD-3-Clause",
              "apache-2.0": "Apache-2.0", "zlib": "Zlib", "bsl-1.0": "BSL-1.0", "bsl-1": "BSL-1.0", "mpl-2": "MPL-2.0",
              "mpl-2.0": "MPL-2.0", "ftl": "FTL", "libpng": "libpng-2.0", "isc": "ISC", "lgpl-2.1": "LGPL-2.1-only",
              "lgpl-2.1+": "LGPL-2.1-or-later", "lgpl-2+": "LGPL-2.0-or-later", "lgpl-3+": "LGPL-3.0-or-later",
              "gpl-2": "GPL-2.0-only", "gpl-2+": "GPL-2.0-or-later", "gpl-3": "GPL-3.0-only", "gpl-3+": "GPL-3.0-or-later",
              "bitstream-vera": "Bitstream-Vera", "cc0-1.0": "CC0-1.0"}


def output_of(*command) -> str:
    return subprocess.run([str(word) for word in command], capture_output=True, text=True).stdout


@functools.cache
def debian_package(file: Path) -> str:
    """That the file belongs to, or ""."""
    names = {str(file), str(file).removeprefix("/usr"), "/usr" + str(file)}
    for line in output_of("dpkg-query", "-S", *names).splitlines():
        return line.split(":")[0]
    return ""


@functools.cache
def debian_version(package: str) -> str:
    found = output_of("dpkg-query", "-W", "-f", "${db:Status-Abbrev}${Version}\n", package).splitlines()
    return found[0][3:] if found and found[0].startswith("ii") else ""


def spdx_of(name: str) -> str:
    """A licence expression from a name in a Debian copyright file, or NOASSERTION."""
    parts = re.split(r"\s+(and|or)\s+", name.strip(), flags=re.IGNORECASE)
    words = [part.upper() if part.lower() in ("and", "or") else SPDX_NAMES.get(part.lower(), "") for part in parts]
    return " ".join(words) if all(words) else "NOASSERTION"


def vendor() -> str:
    """debian or ubuntu: whose packages these are."""
    found = re.search(r"^ID=(\w+)", Path("/etc/os-release").read_text(), re.MULTILINE)
    return found.group(1) if found else "debian"


def debian_licence(package: str) -> tuple[str, str]:
    """Of the package as a whole, and the names of all that its files have."""
    try:
        text = Path("/usr/share/doc", package, "copyright").read_text(errors="replace")
    except OSError:
        return "NOASSERTION", ""
    whole = re.search(r"^Files: \*\n(?:.+\n)*?License: (.+)$", text, re.MULTILINE)
    names = sorted(set(re.findall(r"^License: (.+)$", text, re.MULTILINE)))
    return (spdx_of(whole.group(1)) if whole else "NOASSERTION"), ", ".join(names)


@functools.cache
def system_file(library: str) -> Path | None:
    """Where the system has the library that a bundled one is a copy of."""
    for line in output_of("/sbin/ldconfig", "-p").splitlines():
        if line.strip().startswith(library + " "):
            return Path(line.split("=>")[1].strip()).resolve()
    return None


def needed_libraries(prefix: Path) -> tuple[dict[str, str], dict[str, str]]:
    """Versions by Debian package: of what stands in the prefix, and of what it needs beside."""
    held, needed = {}, {}
    for file in sorted(prefix.rglob("*")):
        if not file.is_file() or file.is_symlink() or file.read_bytes()[:4] != b"\x7fELF":
            continue
        for name, path in re.findall(r"^\s*(\S+) => (/\S+)", output_of("ldd", file), re.MULTILINE):
            is_held = Path(path).resolve().is_relative_to(prefix)
            if name.startswith("libweir_"):
                continue
            original = system_file(name) if is_held else Path(path).resolve()
            package = debian_package(original) if original else ""
            (held if is_held else needed)[package or name] = debian_version(package) if package else ""
    return held, {name: version for name, version in needed.items() if name not in held}


def page_packages(prefix: Path, source: Path) -> list[tuple[str, str, str]]:
    """Name, version and licence of what is in the studio's page, where there is one."""
    if not list(prefix.glob("share/weir/*/index.html")):
        return []
    lock = json.loads((source / "apps/studio/web/package-lock.json").read_text())
    return [(path.split("node_modules/")[-1], entry["version"], entry.get("license", "NOASSERTION"))
            for path, entry in sorted(lock["packages"].items())
            if path and not entry.get("dev") and "/@types/" not in path]


def nanobind_version(prefix: Path) -> str:
    """Of the library that the Python extension was compiled with, if there is one."""
    try:
        return importlib.metadata.version("nanobind") if list(prefix.glob("_core.*")) else ""
    except importlib.metadata.PackageNotFoundError:
        return ""


class Document:
    """Packages, and how they are related to Weir."""

    def __init__(self, version: str, created: str):
        self.packages = [self.package("weir", version, "Apache-2.0", "", "NOASSERTION")]
        self.relationships = [("SPDXRef-DOCUMENT", "DESCRIBES", self.packages[0]["SPDXID"])]
        self.created, self.version = created, version

    @staticmethod
    def package(name, version, licence, comment, reference):
        entry = {"SPDXID": "SPDXRef-Package-" + re.sub(r"[^A-Za-z0-9.-]+", "-", f"{name}-{version}").strip("-"), "name": name,
                 "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "licenseConcluded": "NOASSERTION",
                 "licenseDeclared": licence, "copyrightText": "NOASSERTION"}
        if version:
            entry["versionInfo"] = version
        if comment:
            entry["licenseComments"] = comment
        if reference != "NOASSERTION":
            entry["externalRefs"] = [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                      "referenceLocator": reference}]
        return entry

    def add(self, relation, entry):
        if any(other["SPDXID"] == entry["SPDXID"] for other in self.packages):
            return
        self.packages.append(entry)
        self.relationships.append((self.packages[0]["SPDXID"], relation, entry["SPDXID"]))

    def add_debian(self, relation, name, version):
        licence, names = debian_licence(name)
        comment = f"Licences of its files, as Debian's copyright file names them: {names}" if names else ""
        reference = f"pkg:deb/{vendor()}/{name}@{version}".replace("+", "%2B") if version else "NOASSERTION"
        self.add(relation, self.package(name, version, licence, comment, reference))

    def text(self) -> str:
        content = {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT",
                   "name": f"weir-{self.version}",
                   "creationInfo": {"created": self.created, "creators": ["Tool: weir-make_sbom"]},
                   "packages": self.packages,
                   "relationships": [{"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b}
                                     for a, kind, b in self.relationships]}
        digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
        content["documentNamespace"] = f"https://spdx.org/spdxdocs/weir-{self.version}-{digest[:32]}"
        return json.dumps(content, indent=1) + "\n"


def time_of(prefix: Path) -> str:
    program = next(iter(prefix.glob("bin/weir")), prefix)
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH", program.stat().st_mtime))
    return datetime.fromtimestamp(seconds, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def main(prefix: Path, source: Path) -> None:
    version = re.search(r"project\(Weir VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text()).group(1)
    document = Document(version, time_of(prefix))
    held, needed = needed_libraries(prefix)
    for name, found in sorted(held.items()):
        document.add_debian("CONTAINS", name, found)
    for name in COMPILED_IN:
        if found := debian_version(name):
            document.add_debian("CONTAINS", name, found)
    if found := nanobind_version(prefix):
        document.add("CONTAINS", document.package("nanobind", found, "BSD-3-Clause", "", f"pkg:pypi/nanobind@{found}"))
    for name, found, licence in page_packages(prefix, source):
        reference = f"pkg:npm/{name.replace('@', '%40')}@{found}"
        document.add("CONTAINS", document.package(name, found, licence, "", reference))
    for name, found in sorted(needed.items()):
        document.add_debian("DEPENDS_ON", name, found)
    target = prefix / "share/doc/weir/weir.spdx.json"
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(document.text())


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*(Path(argument).resolve() for argument in sys.argv[1:]))
