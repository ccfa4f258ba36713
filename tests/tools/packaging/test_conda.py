"""The conda recipe says what the rest of the project says."""

import importlib.util
import re
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
RECIPE = SOURCE / "tools" / "packaging" / "conda" / "recipe.yaml"


def found(pattern, file):
    return re.search(pattern, file.read_text(encoding="utf-8"), re.MULTILINE).group(1)


class CondaRecipe(unittest.TestCase):
    def test_the_version_is_the_projects(self):
        self.assertEqual(found(r'^  version: "(.*)"$', RECIPE), found(r"^project\(Weir VERSION ([0-9.]+)", SOURCE / "CMakeLists.txt"))

    def test_the_licence_is_the_projects(self):
        licence = (SOURCE / found(r"^  license_file: (.*)$", RECIPE)).read_text(encoding="utf-8")
        name = " ".join(licence.split()[:4])
        self.assertEqual(name, "Apache License Version 2.0,")
        self.assertEqual(found(r"^  license: (.*)$", RECIPE), "Apache-2.0")

    def test_the_summary_is_the_projects(self):
        self.assertEqual(found(r"^  summary: (.*)$", RECIPE), found(r'^description = "(.*)"$', SOURCE / "pyproject.toml"))

    def test_it_needs_what_the_python_package_needs(self):
        project = (SOURCE / "pyproject.toml").read_text(encoding="utf-8")
        lists = re.findall(r"^(?:requires|dependencies) = \[(.*)\]$", project, re.MULTILINE)
        needs = [need for text in lists for need in re.findall(r'"([^";]+)"', text)]  # without those of old Pythons
        self.assertEqual(len(needs), 3)
        recipe = RECIPE.read_text(encoding="utf-8")
        for need in needs:
            name, versions = re.fullmatch(r"([a-z-]+)(.*)", need).groups()
            self.assertIn(f"    - {name} {versions}\n", recipe)

    @unittest.skipUnless(importlib.util.find_spec("rattler_build"), "there is no py-rattler-build")
    def test_rattler_build_takes_it(self):
        from rattler_build import Stage0Recipe, VariantConfig

        made = Stage0Recipe.from_file(RECIPE).render(VariantConfig({"python": ["3.12.* *_cpython"], "c_stdlib": ["sysroot"]}))
        self.assertEqual([str(variant.recipe.package.name) for variant in made], ["weir"])


if __name__ == "__main__":
    unittest.main()
