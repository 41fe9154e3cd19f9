# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/options.md: all options, as their lists in the libraries describe them, and where users set them.

usage: options_page.py PALPATE PAGE        (PALPATE: the command; the Python module must be on the path)
"""
import functools
import pathlib
import re
import subprocess
import sys

import palpate
from palpate import _palpate

HEAD = """# Options

The options of the library, struct by struct. A field has one name: `min_signal` as a keyword argument in Python, in scene files
and in the C interface, `--min-signal` on the command line and `min-signal` in project files. A flag that is True by default is
switched off by `--no-NAME`, and a table is given row by row (`--anchor 320,240,705`). An option with another name stands behind
the meaning. In C++ it is the member of the struct, except
for some fields of `BuildOptions`: `accuracy`, `passive` (`mode`), `max_bases`, `try_certified`, `compare_always` and
`displacement_noise` are in its `fit`, and `blend` is `blend_rule`. `on` and other members of `CouplingOptions` are named without
`coupling`; `decimal`, `forces_on` and `normals` of `AcquisitionMapping` are explained there.
Angles are in radian (rad); on the command line and in project files they are in degrees.
`--help` shows the usual fields, `--help-all` also the *expert* ones, which few users need. A value outside its range is refused.

This page is written by `./dev studies options_page`.
"""


@functools.cache
def help_of(program, command, flag="--help-all"):
    return subprocess.run([program, *command.split(), flag], capture_output=True, text=True, check=True).stdout


def options_of_commands(program):
    """Name of each command -> its options, each with whether it takes a text."""
    commands, waiting = {}, [""]
    while waiting:
        command = waiting.pop(0)
        below = re.findall(r"^(?=.{30}\S)  ([a-z]+) {2,}\S", help_of(program, command, "--help"), re.M)
        if below:
            waiting += [f"{command} {name}".strip() for name in below]
        else:
            found = re.findall(r"(--[a-z][a-z0-9-]*)([ A-Z]*)", help_of(program, command))[::-1]  # the first counts
            commands[command] = {name: kind.startswith(" TEXT") for name, kind in found}
    return commands


def keywords_of_functions():
    """Name of each function or class of the Python module -> its keyword arguments, and its docstring."""
    found = {}
    for name in palpate.__all__:
        doc = getattr(getattr(palpate, name), "__init__", None) if isinstance(getattr(palpate, name), type) \
            else getattr(palpate, name)
        signature = re.match(r"\w+\((.*)\) -> ", getattr(doc, "__doc__", None) or "")
        if signature and "*, " in signature.group(1):
            found[name] = set(re.findall(r"(\w+): ", signature.group(1).split("*, ", 1)[1])), doc.__doc__
    return found


def option(field):
    return ("--no-" if field["default"] == "True" else "--") + (field["option"] or field["name"]).replace("_", "-")


def choices(field):
    words = re.fullmatch(r"Literal\[(.*)\]", field["type"])
    return words.group(1) if words else ""


def doors(fields, commands, functions):
    """The commands and the Python functions that take all these fields; others have options of these names, too."""
    def takes(options, field):
        return option(field) in options and not (options[option(field)] and field["type"] in ("int", "float"))

    def describes(names, doc, field):
        return field["name"] in names and field["description"] in doc

    return ([name for name, known in commands.items() if all(takes(known, field) for field in fields)],
            [name for name, known in functions.items() if all(describes(*known, field) for field in fields)])


def page(program):
    commands, functions = options_of_commands(program), keywords_of_functions()
    text = HEAD
    for struct, fields in _palpate._option_lists():
        by_command, by_function = doors(fields, commands, functions)
        places = [f"`palpate {name}`" for name in by_command] + [f"`palpate.{name}` (Python)" for name in by_function]
        text += f"\n## {struct}\n\nSet by {', '.join(places) or 'C++ alone'}.\n\n"
        text += "| field | default | range | unit | meaning |\n|---|---|---|---|---|\n"
        for field in fields:
            expert = " *(expert)*" if field["expert"] else ""
            meaning = field["description"].replace("|", "\\|") + (f" (`{option(field)}`)" if field["option"] else "")
            text += f"| `{field['name']}` | {field['default']} | {field['range'] or choices(field)} | {field['unit']} | {meaning}{expert} |\n"
    return text


if __name__ == "__main__":
    pathlib.Path(sys.argv[2]).write_text(page(sys.argv[1]))
