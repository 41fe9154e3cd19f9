# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""check_readme.py on short texts."""
import unittest

from check_readme import check

EXAMPLE = "int main() {\n  step();\n}\n"


class CheckReadme(unittest.TestCase):
    def test_accepts_blocks_of_the_examples_and_links_that_exist(self):
        text = "```cpp\n  step();\n```\n[a](docs/a.md#part), [b](https://example.org)"
        self.assertEqual(check(text, [EXAMPLE], lambda link: link == "docs/a.md"), [])

    def test_refuses_a_block_that_no_example_contains(self):
        self.assertIn("no file", check("```cpp\n  walk();\n```\n", [EXAMPLE], lambda link: True)[0])

    def test_refuses_a_link_to_nothing(self):
        self.assertIn("docs/a.md", check("![a](docs/a.md)", [EXAMPLE], lambda link: False)[0])


if __name__ == "__main__":
    unittest.main()
