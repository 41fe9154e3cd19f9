# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""write_manual.py FOLDER COMMANDS.json [HELP.txt...]: writes manual pages and completions for bash, zsh and fish.

COMMANDS.json is what `palpate --help-all --json` prints; HELP.txt what another program, named like the file, prints with --help.
"""
import gzip
import json
import re
import sys
from pathlib import Path

SHARED = "Options of every command"


def walk(command, path=()):
    """The command and all below it, each with its path of names."""
    path = (*path, command["name"])
    yield path, command
    for part in command["commands"]:
        yield from walk(part, path)


def value_of(option):
    """The name of the value of an option, its choices, and its range in words."""
    if not option["values"]:
        return "", [], ""
    name, _, allowed = option.get("type", "").partition(":")
    choices = re.fullmatch(r"\{(.*)\}", allowed)
    return name or "VALUE", choices[1].split(",") if choices else [], "" if choices else allowed


def options_of(command, root):
    """The options of a command, those of every command last."""
    own = [option for option in command["options"] if option["group"] != SHARED]
    return own + [option for option in root["options"] if option["group"] == SHARED]


# --- manual pages ---


def roff(text):
    return re.sub(r"^([.'])", r"\\&\1", text.replace("\\", "\\e").replace("-", "\\-"), flags=re.M)


def option_lines(option):
    value, choices, allowed = value_of(option)
    names = ", ".join(f"\\fB{roff(name)}\\fR" for name in option["names"])
    if value and not option["positional"]:
        names += f" \\fI{roff(value)}\\fR"
    notes = [f"one of {', '.join(choices)}"] if choices else []
    notes += [allowed] if allowed else []
    notes += [f"default {option['default']}"] if "default" in option else []
    notes += ["required"] if option["required"] else []
    return [".TP", names, roff(option["meaning"] + (f" [{'; '.join(notes)}]" if notes else ""))]


def more_lines(text):
    """The text after the options: paragraphs, and lines that begin with spaces as they are."""
    lines, verbatim = [], False
    for line in text.split("\n"):
        if line.startswith("  ") != verbatim:
            verbatim = not verbatim
            lines.append(".PP\n.nf" if verbatim else ".fi")
        if re.fullmatch(r"Examples?:", line):
            lines.append(".SH EXAMPLES")
        elif line:
            lines.append(roff(line) if verbatim else ".PP\n" + roff(line))
    return lines + ([".fi"] if verbatim else [])


def page(path, command, root, above):
    title = "-".join(path)
    lines = [f'.TH "{title.upper()}" 1 "" "Palpate" "Palpate"', ".ad l", ".SH NAME", f"{roff(title)} \\- {roff(command['meaning'])}",
             ".SH SYNOPSIS", f"\\fB{roff(' '.join(path))}\\fR [\\fIOPTIONS\\fR]"
             + "".join(f" \\fI{roff(option['names'][0])}\\fR{'...' * (option['values'] > 1)}" for option in command["options"] if option["positional"])
             + (" \\fICOMMAND\\fR" if command["commands"] else "")]
    groups = {}
    for option in options_of(command, root):
        groups.setdefault("Arguments" if option["positional"] else option["group"], []).append(option)
    for group, options in groups.items():
        lines += [f".SH {roff(group.upper())}"] + [line for option in options for line in option_lines(option)]
    if command["commands"]:
        lines.append(".SH COMMANDS")
        for part in command["commands"]:
            lines += [".TP", f"\\fB{roff('-'.join((*path, part['name'])))}\\fR(1)", roff(part["meaning"])]
    if command["more"] != above:
        lines += [".SH NOTES"] * (not re.match(r"Examples?:", command["more"])) + more_lines(command["more"])
    return "\n".join(lines) + "\n"


def page_of_help(name, text):
    """A program whose options are not described as JSON: its help as it is."""
    return "\n".join([f'.TH "{name.upper()}" 1 "" "Palpate" "Palpate"', ".SH NAME",
                      f"{roff(name)} \\- {roff(text.splitlines()[0])}", ".SH DESCRIPTION", ".nf", roff(text.rstrip()), ".fi", ""])


# --- completions ---


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def bash(commands, root):
    words, values = [], []
    for path, command in commands:
        name = " ".join(path)
        flags = [flag for option in options_of(command, root) if not option["positional"] for flag in option["names"]]
        parts = [part["name"] for part in command["commands"]]
        words.append(f"    {quoted(name)}) words={quoted(' '.join(flags))} parts={quoted(' '.join(parts))} ;;")
        values += [f"    {quoted(f'{name} {flag}')}) words={quoted(' '.join(choices))} ;;"
                   for option in options_of(command, root) if (choices := value_of(option)[1]) for flag in option["names"]]
    known = "|".join(quoted(" ".join(path)) for path, _ in commands)
    return "\n".join(["# bash completion for palpate", "_palpate() {",
                      "  local current=${COMP_WORDS[COMP_CWORD]} path=palpate words= parts= word",
                      '  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do',
                      f'    case "$path $word" in {known}) path+=" $word" ;; esac', "  done", '  case "$path" in', *words, "  esac",
                      "  [[ $current == -* ]] || words=$parts", '  case "$path ${COMP_WORDS[COMP_CWORD-1]}" in', *values, "  esac",
                      '  COMPREPLY=($(compgen -W "$words" -- "$current"))', "}", "complete -o default -F _palpate palpate", ""])


def zsh(commands, root):
    def text(meaning):
        return re.sub(r"([\[\]:\\])", r"\\\1", meaning)

    cases = []
    for path, command in commands:
        arguments = []
        for option in options_of(command, root):
            value, choices, _ = value_of(option)
            after = f":{value}:({' '.join(choices)})" if choices else f":{value}:_files" if value else ""
            if not option["positional"]:
                arguments += [quoted(f"{flag}[{text(option['meaning'])}]{after}") for flag in option["names"]]
        parts = [quoted(f"{part['name']}:{text(part['meaning'])}") for part in command["commands"]]
        what = f"commands=({' '.join(parts)}); " if parts else ""
        cases.append(f"    {quoted(' '.join(path))}) {what}_arguments -S : " + " ".join(arguments)
                     + (" '*:command:{_describe command commands}' ;;" if parts else " '*:file:_files' ;;"))
    known = "|".join(quoted(" ".join(path)) for path, _ in commands)
    return "\n".join(["#compdef palpate", "_palpate() {", "  local path_=palpate word", "  local -a commands",
                      "  for word in ${words[2,CURRENT-1]}; do", f'    case "$path_ $word" in {known}) path_+=" $word" ;; esac',
                      "  done", '  case "$path_" in', *cases, "  esac", "}", '_palpate "$@"', ""])


def fish(commands, root):
    lines = ["# fish completion for palpate"]
    for path, command in commands:
        seen = [f"__fish_seen_subcommand_from {name}" for name in path[1:]]
        below = " ".join(part["name"] for part in command["commands"])
        here = "; and ".join(seen + ([f"not __fish_seen_subcommand_from {below}"] if below else []))
        for part in command["commands"]:
            lines.append(f"complete -c palpate -f -n {quoted(here)} -a {part['name']} -d {quoted(part['meaning'])}")
        for option in options_of(command, root):
            value, choices, _ = value_of(option)
            if option["positional"]:
                continue
            names = " ".join(f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in option["names"])
            value = f" -x -a {quoted(' '.join(choices))}" if choices else " -r" if value else ""
            lines.append(f"complete -c palpate -n {quoted(here)} {names}{value} -d {quoted(option['meaning'])}")
    return "\n".join(lines) + "\n"


def write_page(folder, name, text):
    (folder / f"{name}.1.gz").write_bytes(gzip.compress(text.encode(), 9, mtime=0))  # no time: the same bytes from each build


def main(folder, description, *helps):
    root = json.loads(description.read_text())
    commands = list(walk(root))
    folder.mkdir(parents=True, exist_ok=True)
    more = {path: command["more"] for path, command in commands}
    for path, command in commands:
        above = more.get(path[:-1], "")  # a command without text of its own has that of the one above
        write_page(folder, "-".join(path), page(path, command, root, above))
    for path in helps:
        write_page(folder, path.stem, page_of_help(path.stem, path.read_text()))
    (folder / "palpate.bash").write_text(bash(commands, root))
    (folder / "_palpate").write_text(zsh(commands, root))
    (folder / "palpate.fish").write_text(fish(commands, root))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
