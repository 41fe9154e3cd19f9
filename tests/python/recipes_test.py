# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""The Python code of docs/python.md runs: the tutorial from its beginning to its end, each recipe after it, and the README's."""
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
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
        (readme,) = re.findall(r"^```python\n(.*?)^```", (REPOSITORY / "README.md").read_text(), re.M | re.S)
        tutorial = ""
        recipes = []
        for heading, code in sections():
            if heading.startswith("Recipe: "):
                recipes.append((heading.removeprefix("Recipe: "), code))
            else:
                self.assertFalse(recipes, "the recipes stand at the end")
                tutorial += code + "\n"
        self.assertEqual([name for name, _ in recipes], ["matplotlib", "Open3D", "VTK", "meshio", "trimesh"])
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(REPOSITORY / "demo", pathlib.Path(folder) / "demo")
            begin = 'import palpate\nmodel = palpate.read_model("model")\nmesh = palpate.read_mesh("duck.ply")\n' \
                'map = palpate.read_range_map("demo/truth/duck.tiff", "demo/rig.yaml")\n' \
                'trace = palpate.Playback(model).play(palpate.read_trajectory("demo/trajectory.csv")[0])\n'
            recipes.append(("README", 'tools = palpate.read_trajectory("demo/trajectory.csv")[0]\n' + readme.replace("acquisition.db", "sheet.db")))
            tutorial += 'palpate.write_acquisition("sheet.db", acquisition)\n'
            for name, code in [("tutorial", tutorial)] + [(name, begin + code) for name, code in recipes]:
                if name in NOT_IN_DEBIAN and importlib.util.find_spec(name) is None:
                    compile(code, name, "exec")
                    continue
                with self.subTest(name):
                    done = subprocess.run([sys.executable, "-B", "-c", code], cwd=folder, capture_output=True, text=True, env=os.environ)
                    self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
