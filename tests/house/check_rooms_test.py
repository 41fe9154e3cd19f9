# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""check_rooms.py on small trees with one fault each."""
import tempfile
import unittest
from pathlib import Path

import check_rooms

ORDER = ["low", "high"]


def problems(files, headers={}):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = Path(folder) / "geometry" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return check_rooms.check_folder(Path(folder), "geometry", ORDER, headers)


GOOD = {"src/low/a.h": "", "src/low/a.cpp": '#include "low/a.h"\n', "src/high/b.cpp": '#include "low/a.h"\n',
        "include/palpate/geometry/b.h": ""}


class CheckRooms(unittest.TestCase):
    def test_accepts_includes_that_go_down(self):
        self.assertEqual(problems(GOOD), [])

    def test_refuses_a_source_that_includes_the_room_above(self):
        found = problems(GOOD | {"src/low/a.cpp": '#include "palpate/geometry/b.h"\n'})
        self.assertEqual(len(found), 1)
        self.assertIn("a.cpp:1: room 'low' includes 'high'", found[0])

    def test_refuses_a_public_header_that_includes_the_room_above(self):
        found = problems(GOOD | {"src/low/c.cpp": "", "include/palpate/geometry/c.h": '#include "palpate/geometry/b.h"\n'})
        self.assertEqual(len(found), 1)
        self.assertIn("c.h:1", found[0])

    def test_refuses_a_file_outside_the_rooms(self):
        self.assertIn("not in a room", problems(GOOD | {"src/c.cpp": ""})[0])
        self.assertIn("lists no room 'attic'", problems(GOOD | {"src/attic/c.cpp": ""})[0])

    def test_wants_a_room_for_a_header_without_source(self):
        files = GOOD | {"include/palpate/geometry/d.h": ""}
        self.assertIn("has no source file", problems(files)[0])
        self.assertEqual(problems(files, {("geometry", "d.h"): "low"}), [])

    def test_refuses_types_of_the_same_name_in_two_headers(self):
        files = GOOD | {"src/low/a.h": "struct Call {\n};\n", "src/high/c.h": "struct Call;\n"}
        self.assertEqual(problems(files), [])
        found = problems(files | {"src/high/c.h": "class Call final : public Base {\n};\n"})
        self.assertEqual(len(found), 1)
        self.assertIn("defines Call, as", found[0])


if __name__ == "__main__":
    unittest.main()
