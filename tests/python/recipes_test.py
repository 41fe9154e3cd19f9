# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""The Python code of docs/python.md runs: the tutorial from its beginning to its end, and each recipe after it."""
import importlib.util
import os
import pathlib
import re
import shutil
import tempfile
import unittest

from shared import REPOSITORY

NOT_IN_DEBIAN = {"trimesh"}


def sections():
    """(heading, code of its blocks) in the order of the document."""
    text = (REPOSITORY / "docs/python.md").read_text()
    for part in re.split(r"^#+ ", text, flags=re.M)[1:]:
        code = "\n".join(re.findall(r"^```python\n(.*?)^```", part, re.M | re.S))
        if code:
            yield part.split("\n")[0], code


class Document(unittest.TestCase):
    def test_the_code_runs(self):
        tutorial = ""
        recipes = []
        for heading, code in sections():
            if heading.startswith("Recipe: "):
                recipes.append((heading.removeprefix("Recipe: "), code))
            else:
                self.assertFalse(recipes, "the recipes stand at the end")
                tutorial += code + "\n"
        self.assertEqual([name for name, _ in recipes], ["matplotlib", "Open3D", "VTK", "meshio", "trimesh"])
        prelude = (
            "import palpate\n"
            'model = palpate.read_model("model")\n'
            'mesh = palpate.read_mesh("duck.ply")\n'
            'map = palpate.read_range_map("demo/truth/duck.tiff", "demo/rig.yaml")\n'
            'tools = palpate.read_trajectory("demo/trajectory.csv")[0]\n'
            "trace = palpate.Playback(model).play(tools)\n"
        )
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(REPOSITORY / "demo", pathlib.Path(folder) / "demo")
            os.chdir(folder)
            exec(compile(tutorial, "tutorial", "exec"), {})
            begin = {}
            exec(prelude, begin)
            for name, code in recipes:
                with self.subTest(name):
                    compiled = compile(code, name, "exec")
                    if name not in NOT_IN_DEBIAN or importlib.util.find_spec(name) is not None:
                        exec(compiled, dict(begin))
            os.chdir(REPOSITORY)


if __name__ == "__main__":
    unittest.main()
