# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""The stubs say what the module has, and the code of docs/python.md and README.md has the types that they say."""
import ast
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import palpate
import palpate._palpate as compiled
from recipes_test import sections
from shared import REPOSITORY

PACKAGE = pathlib.Path(palpate.__file__).parent


def run(*words, **options):
    environment = dict(os.environ, MYPYPATH=str(PACKAGE.parent))
    return subprocess.run([sys.executable, "-B", "-m", *words], capture_output=True, text=True, env=environment, **options)


def functions_of(stub, prefix=""):
    """Name -> names of arguments, those that must be named after "*", without self."""
    found = {}
    for node in stub.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            found |= functions_of(node, node.name + ".")
        if isinstance(node, ast.FunctionDef) and not node.decorator_list:
            arguments = [a.arg for a in node.args.args] + (["*"] if node.args.kwonlyargs else [])
            arguments += [a.arg for a in node.args.kwonlyargs]
            defaults = len(node.args.defaults) + sum(default is not None for default in node.args.kw_defaults)
            found[prefix + node.name] = ([a for a in arguments if a != "self"], defaults)
    return found


class Stubs(unittest.TestCase):
    def test_the_module_has_what_the_stubs_say_and_nothing_else(self):
        with tempfile.TemporaryDirectory() as folder:
            config = pathlib.Path(folder) / "mypy.ini"
            config.write_text("[mypy]\n")
            done = run("mypy.stubtest", "palpate", "--mypy-config-file", str(config))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_arguments_are_those_of_the_stubs(self):
        stub = functions_of(ast.parse((PACKAGE / "_palpate.pyi").read_text()))
        compared = 0
        for name, (arguments, defaults) in stub.items():
            owner, _, method = name.rpartition(".")
            if method.startswith("__") and method != "__init__":
                continue
            function = getattr(getattr(compiled, owner), method) if owner else getattr(compiled, method)
            signature = re.match(r"\w+\((.*)\) -> ", function.__doc__ or "")
            if signature is None:
                continue
            written = re.sub(r"\[[^\]]*\]", "", signature.group(1))
            words = [part.strip() for part in written.split(",") if part.strip()]
            names = [re.split(r"[:=]", word)[0] for word in words]
            self.assertEqual([n for n in names if n not in ("self", "arg0")], arguments, name)
            self.assertEqual(sum("=" in word for word in words), defaults, name)
            compared += 1
        self.assertGreater(compared, 40)

    def test_everything_is_described(self):
        for name in palpate.__all__:
            self.assertTrue(getattr(palpate, name).__doc__, name)
            for member, value in vars(getattr(palpate, name)).items() if isinstance(getattr(palpate, name), type) else ():
                if isinstance(value, property):
                    self.assertTrue(value.__doc__, f"{name}.{member}")

    def test_functions_name_what_an_object_has_that_they_return(self):
        checked = 0
        for owner in (palpate, *(getattr(palpate, name) for name in palpate.__all__)):
            for name, function in vars(owner).items() if isinstance(owner, type) or owner is palpate else ():
                doc = getattr(function, "__doc__", None) or ""
                result = re.match(r"\w+\(.*\) -> (?:Optional\[)?(?:palpate\.)?([A-Z]\w+)", doc)
                if result is None or not hasattr(palpate, result.group(1)):
                    continue
                returned = getattr(palpate, result.group(1))
                for member in dir(returned):
                    if isinstance(getattr(returned, member), property):
                        self.assertRegex(doc, rf"Returns .*\b{member}\b", name)
                        checked += 1
        self.assertGreater(checked, 200)

    def test_objects_are_shown_by_what_they_have(self):
        mesh = palpate.TriangleMesh([[0, 0, 0], [3, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        self.assertEqual(repr(palpate.geodesic_distance(mesh, [0])),
                         "<palpate.GeodesicDistance: distance=[0, 3, 4], label=(3,) int32>")
        self.assertTrue(repr(palpate.repair(mesh)).startswith(
            "<palpate.RepairedMesh: mesh=TriangleMesh, source=(3,) int32, removed_triangles=0, "))
        self.assertEqual(repr(palpate.GeodesicSurface(mesh)), "<palpate.GeodesicSurface>")
        for name in palpate.__all__:
            value = getattr(palpate, name)
            if isinstance(value, type) and not issubclass(value, Exception):
                self.assertIsNot(value.__repr__, object.__repr__, name)
        self.assertIs(palpate.BallPlacement.__repr__, palpate.ArmPlacement.__repr__)

    def test_the_document_names_all_that_one_calls(self):
        text = (REPOSITORY / "docs/python.md").read_text()
        stub = functions_of(ast.parse((PACKAGE / "_palpate.pyi").read_text()))
        called = {name.removesuffix(".__init__") for name in stub if "." not in name or name.endswith(".__init__")}
        self.assertGreater(len(called), 35)
        for name in called:
            self.assertRegex(text, rf"`(palpate\.)?{name}\b", name)

    def test_the_code_of_the_document_has_the_right_types(self):
        tutorial = "\n".join(code for heading, code in sections() if not heading.startswith("Recipe"))
        (readme,) = re.findall(r"^```python\n(.*?)^```", (REPOSITORY / "README.md").read_text(), re.M | re.S)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "tutorial.py"
            path.write_text(tutorial + readme)
            done = run("mypy", "--strict", str(path), str(PACKAGE / "_notebook.py"))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
