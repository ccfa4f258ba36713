#!/usr/bin/env python3
"""What tools/abi/check_abi.py lets pass and what it refuses, with small libraries: test_check_abi.py CXX"""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CHECK = ROOT / "tools/abi/check_abi.py"
CXX = "c++"

PUBLIC = """
namespace weir {
struct Place { int line = 0; long column = 0; };
struct Node { virtual ~Node(); virtual void step(const Place& place); };
template <class T> struct Held { T value; };
int depth(const Node& node);
}
"""
PRIVATE = "namespace weir { struct Inner { int a; }; int work(Inner& inner); }"
SOURCE = """
#include "public.h"
#include "private.h"
namespace weir {
Node::~Node() {}
void Node::step(const Place&) {}
int depth(const Node&) { return 1; }
int work(Inner& inner) { return inner.a; }
}
"""


class CheckAbi(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.build("1.0", PUBLIC)
        self.assertEqual(self.check("--update"), "")

    def build(self, version, public=PUBLIC, private=PRIVATE, source=SOURCE, flags=()):
        generated = self.root / "generated/framework/graph"
        generated.mkdir(parents=True, exist_ok=True)
        (generated / "interface_digest.h").write_text(f'char kInterfaceIdentity[] = "0.1.0, interface {version}, headers 0";')
        (self.root / "public.h").write_text(public)
        (self.root / "private.h").write_text(private)
        (self.root / "source.cpp").write_text(source)
        (self.root / "generated/public_headers.txt").write_text(f"{self.root}/public.h\n")
        (self.root / "lib").mkdir(exist_ok=True)
        (self.root / "interface").mkdir(exist_ok=True)
        library = self.root / "library.so"
        subprocess.run([CXX, *flags, "-g", "-fPIC", "-shared", "-I", self.root, self.root / "source.cpp", "-o", library], check=True)
        for room in ("framework", "nodes"):
            shutil.copy(library, self.root / f"lib/libweir_{room}.so")
            shutil.copy(library, self.root / f"interface/libweir_{room}_interface.so")

    def check(self, *options):
        """What it says when it fails; "" if it does not."""
        done = subprocess.run([sys.executable, "-B", CHECK, *options, self.root, self.root / "baseline"], capture_output=True,
                              text=True)
        self.assertEqual(done.returncode != 0, done.stderr.startswith("check_abi: "), done.stderr)
        return done.stderr

    def test_the_same_passes(self):
        self.assertEqual(self.check(), "")

    def test_private_headers_and_comments_may_change(self):
        self.build("1.0", "// A comment.\n" + PUBLIC, PRIVATE.replace("int a", "long a").replace("work(", "labour("),
                   SOURCE.replace("work(", "labour(").replace("return inner.a", "return 0"))
        self.assertEqual(self.check(), "")

    def test_functions_may_be_added(self):
        self.build("1.0", PUBLIC.replace("int depth(", "int width(const Node& node);\nint depth("),
                   source=SOURCE.replace("int depth(", "int width(const Node&) { return 2; }\nint depth("))
        self.assertEqual(self.check(), "")

    def test_another_member_is_refused(self):
        self.build("1.0", PUBLIC.replace("long column = 0;", "long column = 0; double angle = 0;"))
        said = self.check()
        self.assertIn("double angle", said)
        self.assertIn("WEIR_INTERFACE_VERSION in CMakeLists.txt to 2.0", said)

    def test_a_type_of_a_member_is_refused(self):
        self.build("1.0", PUBLIC.replace("int line", "float line"))
        self.assertIn("'int' to 'float'", self.check())

    def test_another_virtual_function_is_refused(self):
        self.build("1.0", PUBLIC.replace("virtual void step(", "virtual void frame();\nvirtual void step("),
                   source=SOURCE.replace("Node::~Node() {}", "Node::~Node() {}\nvoid Node::frame() {}"))
        self.assertIn("vtable", self.check())

    def test_a_function_that_is_gone_is_refused(self):
        self.build("1.0", PUBLIC.replace("int depth(const Node& node);", ""),
                   source=SOURCE.replace("int depth(const Node&) { return 1; }", ""))
        self.assertIn("weir::depth", self.check())

    def test_another_argument_is_refused(self):
        self.build("1.0", PUBLIC.replace("int depth(const Node& node)", "int depth(const Node& node, int most)"),
                   source=SOURCE.replace("int depth(const Node&)", "int depth(const Node&, int)"))
        self.assertIn("weir::depth", self.check())

    def test_a_raised_version_asks_for_another_baseline(self):
        changed = PUBLIC.replace("long column = 0;", "long column = 0; double angle = 0;")
        self.build("1.1", changed)  # the second number is for additions alone
        self.assertIn("double angle", self.check("--update"))
        self.build("2.0", changed)
        self.assertIn("the interface is 2.0, and", self.check())
        self.assertEqual(self.check("--update"), "")
        self.assertEqual(self.check(), "")
        self.assertEqual((self.root / "baseline/version").read_text(), "2.0\n")

    def test_what_no_source_with_debug_information_defines_is_named(self):
        self.build("1.0", source=SOURCE.replace("int depth(const Node&) { return 1; }", ""))
        shutil.copy(self.root / "interface/libweir_nodes_interface.so", self.root / "kept.so")
        self.build("1.0")
        shutil.copy(self.root / "kept.so", self.root / "interface/libweir_nodes_interface.so")
        self.assertIn("_ZN4weir5depth", self.check())

    def test_a_missing_baseline_is_named(self):
        shutil.rmtree(self.root / "baseline")
        self.assertIn("./dev check-abi --update", self.check())

    def test_kernels_for_instructions_of_a_processor_do_not_count(self):
        public = PUBLIC.replace("int depth", "template <class T> int depthOn(T& device);\nint depth")
        self.build("1.0", public)  # which is described without them
        described = {room: (self.root / f"interface/libweir_{room}_interface.so").read_bytes() for room in ("framework", "nodes")}
        kernel = "\nnamespace weir {\ntemplate <class T> int depthOn(T&) { return 1; }\ntemplate int depthOn(int&);\n}\n"
        self.build("1.0", public, source=SOURCE + kernel, flags=["-fno-weak"])
        for room, library in described.items():
            (self.root / f"interface/libweir_{room}_interface.so").write_bytes(library)
        self.assertEqual(self.check(), "")


if __name__ == "__main__":
    if len(sys.argv) == 2:
        CXX = sys.argv.pop()
    if not shutil.which("abidiff"):
        print("skipped: there is no abidiff")
        sys.exit(77)
    unittest.main()
