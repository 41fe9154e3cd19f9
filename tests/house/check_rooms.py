# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Checks that the rooms of the sources are those of ARCHITECTURE.md, include no room above them, and
that no two headers of a folder define types of the same name: the linker would silently mix them up.

usage: check_rooms.py [REPOSITORY]
"""
import re
import sys
from pathlib import Path

SOURCES = {"core": "core/src", "geometry": "geometry/src", "sensing": "sensing/src", "documents": "documents/src",
           "devices": "devices/src", "probing": "probing/src",
           "acquisition": "acquisition/src", "haptics": "haptics/src", "palpate": "apps/palpate"}
INCLUDE = re.compile(r'#include "([^"]+)"')
TYPE = re.compile(r"^(?:struct|class|enum class) (\w+)\b(?!::)[^;]*?\{", re.M)  # at the level of the namespace


def read_rooms(architecture):
    """Rooms of each folder from bottom to top, and the headers that the text assigns to a room."""
    section = architecture.split("\n## Rooms\n")[1].split("\n## ")[0]
    rooms, headers = {}, {}
    for part in section.split("\n### ")[1:]:
        folder = part.split("\n")[0].strip()
        rooms[folder] = re.findall(r"^- \*\*(\w+)\*\*:", part, re.M)
        for line in re.findall(r"^- \*\*\w+\*\*:.*$", part, re.M):
            for header in re.findall(r"`(\w+\.h)`", line):
                headers[folder, header] = re.match(r"- \*\*(\w+)\*\*", line).group(1)
    return rooms, headers


def check_folder(repository, folder, order, headers):
    """Messages about what is wrong in one folder."""
    base = repository / SOURCES[folder]
    problems = []
    room_of = {}  # every name by which a file can be included -> its room
    for path in sorted([*base.rglob("*.cpp"), *base.rglob("*.h")]):
        inside = path.relative_to(base)
        if len(inside.parts) == 2:
            room_of[str(inside)] = inside.parts[0]
            if inside.parts[0] not in order:
                problems.append(f"{path}: ARCHITECTURE.md lists no room '{inside.parts[0]}' of {folder}")
        elif str(inside) != "main.cpp":
            problems.append(f"{path}: not in a room; move it to one of {', '.join(order)}")
    public = sorted((repository / folder / "include").rglob("*.h")) if folder != "palpate" else []
    stems = {Path(name).stem: room for name, room in room_of.items() if name.endswith(".cpp")}
    for path in public:
        room = headers.get((folder, path.name)) or stems.get(path.stem)
        if room is None:
            problems.append(f"{path}: has no source file; name it with its room in ARCHITECTURE.md")
        room_of[str(path.relative_to(repository / folder / "include"))] = room
    paths = {name: base / name for name in room_of if (base / name).exists()}
    paths |= {str(path.relative_to(repository / folder / "include")): path for path in public}
    for name, path in paths.items():
        room = room_of[name]
        if room not in order:
            continue
        for number, line in enumerate(path.read_text().split("\n"), 1):
            found = INCLUDE.match(line)
            other = room_of.get(found.group(1)) if found else None
            if other in order and order.index(other) > order.index(room):
                problems.append(f"{path}:{number}: room '{room}' includes '{other}', which stands above it")
    for room in order:
        if room not in room_of.values():
            problems.append(f"ARCHITECTURE.md: room '{room}' of {folder} has no files")
    defined = {}
    for path in sorted([*base.rglob("*.h"), *public]):
        for name in TYPE.findall(path.read_text()):
            if name in defined:
                problems.append(f"{path}: defines {name}, as {defined[name]} does; rename one of them")
            defined[name] = path
    return problems


def main():
    repository = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    rooms, headers = read_rooms((repository / "ARCHITECTURE.md").read_text())
    problems = [p for folder in SOURCES for p in check_folder(repository, folder, rooms[folder], headers)]
    print("\n".join(problems) if problems else f"{sum(map(len, rooms.values()))} rooms, none includes upwards")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
