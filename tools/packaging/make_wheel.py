"""Makes a wheel of the Python package of a build, without compiling again what is compiled. It is for all Pythons that
the build has an extension for (python/CMakeLists.txt), and for the systems that have the C library that it asks for.

usage: make_wheel.py BUILD SOURCE OUTPUT_FOLDER      with the Python that the build was made for, which has `wheel`

An installation becomes the package's folder; shared libraries that a bare system may lack are put into it. `pip wheel .`
makes the same, without those, but compiles in a folder of its own.
"""

import platform
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path


def metadata_of(source: Path) -> tuple[str, str]:
    """Version, and the text of METADATA, from CMakeLists.txt, pyproject.toml and README.md."""
    version = re.search(r"project\(Weir VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text()).group(1)
    project = (source / "pyproject.toml").read_text()
    field = {name: re.search(rf'^{name} = "(.*)"$', project, re.MULTILINE).group(1)
             for name in ("name", "description", "requires-python")}
    needs = re.findall(r'"(.+?)"', re.search(r"^dependencies = \[(.*)\]$", project, re.MULTILINE).group(1))
    lines = ["Metadata-Version: 2.1", f"Name: {field['name']}", f"Version: {version}", f"Summary: {field['description']}",
             "License: Apache-2.0", f"Requires-Python: {field['requires-python']}", *(f"Requires-Dist: {n}" for n in needs),
             "Description-Content-Type: text/markdown", "", (source / "README.md").read_text()]
    return version, "\n".join(lines)


def is_elf(file: Path) -> bool:
    if not file.is_file() or file.is_symlink():
        return False
    with file.open("rb") as stream:
        return stream.read(4) == b"\x7fELF"


def platform_tag(package: Path) -> str:
    """Systems with the C library whose symbols the package's files ask for, or a newer one."""
    if platform.libc_ver()[0] != "glibc":
        return sysconfig.get_platform().replace("-", "_").replace(".", "_")
    asked = [(2, 17)]  # the oldest that such a tag can name
    for file in filter(is_elf, package.rglob("*")):
        symbols = subprocess.run(["objdump", "-T", file], check=True, capture_output=True, text=True).stdout
        asked += [(int(major), int(minor)) for major, minor in re.findall(r"GLIBC_(\d+)\.(\d+)", symbols)]
    return "manylinux_{}_{}_{}".format(*max(asked), platform.machine())


def python_tags(package: Path) -> tuple[str, str]:
    """For which Pythons, and which ABIs, it has an extension: of a version, or for all from 3.12 on (abi3)."""
    versions = sorted(re.search(r"cpython-(3\d+)", file.name).group(1) for file in package.glob("_core.cpython-3*.so"))
    pythons, abis = [f"cp{v}" for v in versions], [f"cp{v}" for v in versions]
    if (package / "_core.abi3.so").exists():
        pythons, abis = [*pythons, "cp312"], [*abis, "abi3"]
    return ".".join(pythons), ".".join(sorted(abis))


def main(build: Path, source: Path, output: Path) -> None:
    version, metadata = metadata_of(source)
    if not list((build / "python" / "weir").glob(f"_core.{sys.implementation.cache_tag}*")):
        sys.exit(f"make_wheel: {build} has no Python package for this Python; see the end of its configuration")
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / f"weir-{version}"
        package, info = tree / "weir", tree / f"weir-{version}.dist-info"
        for component in ("Unspecified", "python"):
            subprocess.run(["cmake", "--install", build, "--prefix", package, "--strip", "--component", component], check=True,
                           stdout=subprocess.DEVNULL)
        for file in [*(source / "python" / "weir").glob("*.py"), source / "python" / "weir" / "py.typed"]:
            shutil.copy(file, package)
        subprocess.run([source / "tools/packaging/bundle_libraries.sh", package], check=True)
        subprocess.run([sys.executable, "-B", source / "tools/packaging/make_sbom.py", package, source], check=True)
        info.mkdir()
        shutil.copy(source / "LICENSE", info)
        (info / "METADATA").write_text(metadata)
        (info / "entry_points.txt").write_text("[console_scripts]\nweir = weir._program:main\n")
        (pythons, abis), system = python_tags(package), platform_tag(package)
        tags = "".join(f"Tag: {p}-{a}-{system}\n" for p in pythons.split(".") for a in abis.split("."))
        (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: weir\nRoot-Is-Purelib: false\n{tags}")
        output.mkdir(parents=True, exist_ok=True)
        subprocess.run([sys.executable, "-m", "wheel", "pack", "--dest-dir", output, tree], check=True,
                       stdout=subprocess.DEVNULL)
        print(output / f"weir-{version}-{pythons}-{abis}-{system}.whl")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*(Path(argument).absolute() for argument in sys.argv[1:]))
