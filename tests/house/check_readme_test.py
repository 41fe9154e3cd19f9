# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""check_readme.py on short texts."""
import unittest

from check_readme import MOST_WORDS, check_blocks, check_length

EXAMPLE = "int main() {\n  step();\n}\n"


class CheckReadme(unittest.TestCase):
    def test_accepts_blocks_of_the_examples(self):
        self.assertEqual(check_blocks("a.md", "```cpp\n  step();\n```\n", [EXAMPLE]), [])

    def test_refuses_a_block_that_no_example_contains(self):
        self.assertIn("a.md: no file", check_blocks("a.md", "```cpp\n  walk();\n```\n", [EXAMPLE])[0])

    def test_refuses_more_than_a_page(self):
        self.assertEqual(check_length("word " * MOST_WORDS), [])
        self.assertIn(f"{MOST_WORDS + 1} words", check_length("word " * (MOST_WORDS + 1))[0])


if __name__ == "__main__":
    unittest.main()
