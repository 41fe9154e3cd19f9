# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""check_links.py on short texts."""
import unittest
from pathlib import Path

from check_links import anchors_of, check


def problems(text, other="# Other page\n\n## Its `part`, twice\n\n## Its part, twice\n"):
    return check({Path("docs/a.md"): text, Path("docs/b.md"): other}, lambda path: path == Path("LICENSE"))


class CheckLinks(unittest.TestCase):
    def test_accepts_links_to_files_and_headings(self):
        self.assertEqual(problems("# A\n[1](b.md), [2](b.md#other-page), [3](#a), [4](../LICENSE), [5](https://example.org/x)"), [])

    def test_makes_anchors_as_the_pages_are_shown(self):
        self.assertEqual(anchors_of("# Its `part`, twice\n# Its part, twice\n## [A link](b.md): C++\n```\n# no heading\n```\n"),
                         {"its-part-twice", "its-part-twice-1", "a-link-c"})

    def test_refuses_a_file_that_is_not_there(self):
        self.assertIn("c.md, which does not exist", problems("[1](c.md)")[0])

    def test_refuses_a_heading_that_is_not_there(self):
        self.assertIn("no such heading", problems("[1](b.md#its-parts)")[0])

    def test_does_not_read_code(self):
        self.assertEqual(problems("`[1](c.md)`\n```\n[2](d.md)\n```\n"), [])


if __name__ == "__main__":
    unittest.main()
