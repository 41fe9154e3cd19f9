# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
import unittest

from documented_options import problems_in

THREADS = {"names": ["--threads"], "values": 1}
PROGRAM = {"name": "palpate", "options": [THREADS], "commands": [
    {"name": "probe", "options": [THREADS], "commands": [
        {"name": "run", "options": [{"names": ["-o", "--output"], "values": 1}], "commands": []}]}]}


class DocumentedOptions(unittest.TestCase):
    def check(self, language, code, problems, count=1):
        self.assertEqual(problems_in(f"text\n```{language}\n{code}\n```\n", PROGRAM), (problems, count))

    def test_what_exists_is_accepted(self):
        self.check("console", "$ palpate --threads 2 probe run plan.json --threads=3 \\\n  -o a.db   # --nothing", [])
        self.check("sh", "palpate probe run a.json && palpate probe run b.json", [], 2)
        self.check("console", "submit.sh 8 palpate probe run 'palpate --nothing'", [])
        self.check("python", "palpate probe --nothing", [], 0)

    def test_what_does_not_exist_is_named(self):
        self.check("sh", "palpate probe run --ouput a.db", ["palpate run has no option --ouput"])
        self.check("console", "$ palpate prob run", ["palpate has no command prob"])

    def test_what_is_no_json_is_refused(self):
        self.check("json", '{"a": 1}', [])
        problems, _ = problems_in('```json\n{"a": }\n```\n', PROGRAM)
        self.assertEqual(len(problems), 1)


if __name__ == "__main__":
    unittest.main()
