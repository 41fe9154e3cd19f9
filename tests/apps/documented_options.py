# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""documented_options.py PALPATE: commands and options that blocks ```sh and ```console show exist, also where nothing runs them;
blocks ```json are JSON."""
import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def blocks_of(text):
    return re.findall(r"^```(sh|console|json)\n(.*?)^```", text, re.M | re.S)


def calls_of(code):
    """The words of each call of palpate, without comments and quoted text."""
    for line in code.replace("\\\n", " ").splitlines():
        line = re.sub(r"'[^']*'|(?<=\s)#.*", "", re.sub(r"^\$ ", "", line))
        for call in re.findall(r"(?:^|(?<=[\s\"]))palpate (?!\d)([^|;&>\")]*)", line):
            yield call.split()


def problems_of(words, program):
    """What a call names that the program does not have; `program` is as `palpate --help-all --json` describes it."""
    command, options, value = program, set(), False
    for word in words:
        takes = {name: option["values"] for option in command["options"] for name in option["names"]}
        options |= set(takes)
        commands = {one["name"]: one for one in command["commands"]}
        if word in commands:
            command = commands[word]
        elif command is program and not value and not word.startswith("-"):
            return [f"palpate has no command {word}"]
        value = takes.get(word, 0) != 0
    options |= {name for option in command["options"] for name in option["names"]}
    given = [word.split("=")[0] for word in words if re.match(r"--?[a-z]", word)]
    return [f"palpate {command['name']} has no option {option}" for option in given if option not in options]


def problems_in(page, program):
    problems, count = [], 0
    for language, code in blocks_of(page):
        if language == "json":
            try:
                json.loads(code)
            except json.JSONDecodeError as error:
                problems.append(f"{error}: {code}")
            count += 1
            continue
        for words in calls_of(code):
            problems += problems_of(words, program)
            count += 1
    return problems, count


def main(palpate):
    program = json.loads(subprocess.run([palpate, "--help-all", "--json"], check=True, capture_output=True).stdout)
    problems, count = [], 0
    for path in (*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("demo/*.md"), *ROOT.glob("cluster/*.md")):
        if path.name == "CHANGELOG.md":
            continue
        found, checked = problems_in(path.read_text(), program)
        problems += [f"{path.relative_to(ROOT)}: {problem}" for problem in found]
        count += checked
    print("\n".join(problems) or f"{count} calls and documents")
    return bool(problems) or count < 100


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
