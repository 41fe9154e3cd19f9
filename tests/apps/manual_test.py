# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""manual_test.py PALPATE FOLDER: manual pages and completions in FOLDER have every command and option that --help lists."""
import gzip
import re
import shlex
import subprocess
import sys
from pathlib import Path


def options_in(text):
    return [name for names in re.findall(r"^ +(-[\w,-]+)", text, re.M) for name in names.split(",")]


def listed(program, path=()):
    """The commands with their options, as --help-all lists them: the name of each on a line of its own."""
    text = subprocess.run([program, *path, "--help-all"], check=True, capture_output=True, text=True).stdout
    head, *blocks = re.split(r"^([a-z-]+)\n", text, flags=re.M)
    yield path, options_in(head)
    for name, body in zip(blocks[::2], blocks[1::2]):
        if "  Subcommands:\n" in body:
            yield from listed(program, (*path, name))
        else:
            yield (*path, name), options_in(body)


def completed(folder, calls):
    """What bash offers for the last word of each call."""
    lines = [f'. {shlex.quote(str(folder / "palpate.bash"))}']
    lines += [f'COMP_WORDS=({shlex.join(call)}); COMP_CWORD={len(call) - 1}; _palpate; echo "${{COMPREPLY[*]}}"' for call in calls]
    output = subprocess.run(["bash", "-c", "\n".join(lines)], check=True, capture_output=True, text=True).stdout
    return [line.split() for line in output.splitlines()]


def main(program, folder):
    problems = []
    commands = list(listed(program))
    offered = completed(folder, [("palpate", *path, "-") for path, _ in commands])
    zsh, fish = (folder / "_palpate").read_text(), (folder / "palpate.fish").read_text()
    for (path, options), in_bash in zip(commands, offered, strict=True):
        name = " ".join(("palpate", *path))
        page = folder / f"{name.replace(' ', '-')}.1.gz"
        text = gzip.decompress(page.read_bytes()).decode().replace("\\-", "-") if page.exists() else ""
        in_zsh = next((line for line in zsh.splitlines() if line.startswith(f"    '{name}')")), "")
        in_fish = [line for line in fish.splitlines() if all(f"__fish_seen_subcommand_from {part}" in line for part in path)]
        for option in options:
            flag = f" -l {option[2:]} " if option.startswith("--") else f" -s {option[1:]} "
            problems += [f"{name}: {where} does not have {option}" for where, has in {
                "its manual page": f"\\fB{option}\\fR" in text, "bash": option in in_bash, "zsh": f"'{option}[" in in_zsh,
                "fish": any(flag in line for line in in_fish)}.items() if not has]
    paths = [path for path, _ in commands if path]
    for path, names in zip(paths, completed(folder, [("palpate", *path[:-1], path[-1][:2]) for path in paths]), strict=True):
        problems += [] if path[-1] in names else [f"{' '.join(path)}: bash does not offer it"]
    if completed(folder, [("palpate", "mesh", "--format", "")]) != [["ply", "obj", "stl"]]:
        problems.append("bash does not offer the formats of meshes")
    print("\n".join(problems) or f"{len(commands)} commands, {sum(len(options) for _, options in commands)} options")
    return bool(problems) or len(commands) < 23 or sum(len(options) for _, options in commands) < 400


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2])))
