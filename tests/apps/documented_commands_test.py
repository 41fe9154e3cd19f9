# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""documented_commands.py on short texts and false programs."""
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import documented_commands
from documented_commands import blocks_of, commands_of


class DocumentedCommands(unittest.TestCase):
    def test_finds_the_blocks_that_run(self):
        self.assertEqual(blocks_of("```sh\na\n```\n```console\n$ b\n```\n```python\nc\n```\n"), [("sh", "a\n"), ("python", "c\n")])

    def test_runs_whole_commands_and_knows_the_others(self):
        self.assertEqual(commands_of("./dev demo\npalpate a \\\n  b  # c\n# d\n"), (["palpate a    b  # c"], []))

    def test_runs_here_documents_as_one_command(self):
        code = "cat > a << 'EOF'\n# b\nc: d\nEOF\npalpate a\n"
        self.assertEqual(commands_of(code), (["cat > a << 'EOF'\n# b\nc: d\nEOF", "palpate a"], []))

    def test_refuses_what_it_cannot_run(self):
        self.assertEqual(commands_of("sudo palpate a\n")[1], ["sudo palpate a"])

    def test_tells_commands_that_fail_and_stops_at_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            palpate = Path(folder) / "palpate"
            palpate.write_text("#!/bin/sh\ntest -e demo/rig.yaml && test $1 = good\n")
            palpate.chmod(0o755)
            for name in ("demo", "meshes"):
                (Path(folder) / name).mkdir()
            (Path(folder) / "demo/rig.yaml").touch()
            (Path(folder) / "page.md").write_text("```sh\npalpate bad\npalpate good\n```\n")
            with mock.patch.object(documented_commands, "ROOT", Path(folder)):
                problems, count = documented_commands.problems_of("page.md", palpate)
        self.assertEqual(count, 2)
        self.assertEqual(len(problems), 1)
        self.assertIn("status 1: palpate bad", problems[0])


if __name__ == "__main__":
    unittest.main()
