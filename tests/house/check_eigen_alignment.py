# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Checks that every public header that includes Eigen also includes eigen_alignment.h, directly or not.

usage: check_eigen_alignment.py [REPOSITORY]
"""
import re
import sys
from pathlib import Path

GUARD = "palpate/geometry/eigen_alignment.h"


def unguarded(repository):
    """The public headers that show Eigen without the guard."""
    texts = {}
    for folder in ("geometry", "documents", "sensing", "devices", "probing", "acquisition", "haptics"):
        include = repository / folder / "include"
        texts |= {str(path.relative_to(include)): path.read_text() for path in include.rglob("*.h")}
    assert GUARD in texts, f"{repository}: has no {GUARD}"

    def is_guarded(header):
        return header == GUARD or any(is_guarded(other) for other in
                                      re.findall(r'#include "([^"]+)"', texts[header]) if other in texts)

    return sorted(header for header, text in texts.items() if "#include <Eigen/" in text and not is_guarded(header))


if __name__ == "__main__":
    found = unguarded(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("."))
    for header in found:
        print(f"{header}: includes Eigen; include {GUARD} too")
    sys.exit(1 if found else 0)
