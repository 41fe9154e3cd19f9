# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Each option has one description, and every way to use Palpate takes it."""
import os
import sys
import unittest

from shared import REPOSITORY

sys.path.insert(0, str(REPOSITORY / "studies"))
import options_page  # noqa: E402
from palpate import _palpate  # noqa: E402

PROGRAM = os.environ["PALPATE_COMMAND"]


class Options(unittest.TestCase):
    def test_every_list_can_be_set_by_a_command_and_by_python(self):
        commands, functions = options_page.options_of_commands(PROGRAM), options_page.keywords_of_functions()
        lists = _palpate._option_lists()
        self.assertGreater(len(lists), 0)
        for struct, fields in lists:
            by_command, by_function = options_page.doors(fields, commands, functions)
            self.assertTrue(by_command, f"{struct}: no command has all of its fields")
            self.assertTrue(by_function, f"{struct}: no function of Python has all of its fields")

    def test_commands_take_angles_in_degrees_and_nothing_else(self):
        commands, angles = options_page.options_of_commands(PROGRAM), 0
        for struct, fields in _palpate._option_lists():
            (command, *_), _ = options_page.doors(fields, commands, {})
            shown = options_page.help_of(PROGRAM, command)
            for field in fields:
                text = shown.split(f"  {options_page.option(field)} ")[1].split("\n  -")[0]
                self.assertEqual("[degrees]" in text, field["unit"] == "rad", f"{struct}::{field['name']}: {text}")
                angles += field["unit"] == "rad"
        self.assertGreaterEqual(angles, 2)

    def test_descriptions_are_sentences_without_what_the_list_says_apart(self):
        for struct, fields in _palpate._option_lists():
            for field in fields:
                self.assertRegex(field["description"], r"^[A-Z].*[^.]$", f"{struct}::{field['name']}")
                self.assertNotIn("default", field["description"], f"{struct}::{field['name']}")

    def test_the_page_is_what_the_lists_say(self):
        self.assertEqual((REPOSITORY / "docs/options.md").read_text(), options_page.page(PROGRAM),
                         "docs/options.md is out of date; write it with ./dev studies options_page")


if __name__ == "__main__":
    unittest.main()
