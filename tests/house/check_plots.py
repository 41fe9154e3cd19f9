# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""check_plots.py REPOSITORY: each plot of docs/tables is what studies/doc_plots.py draws from the figures beside it."""
import sys
from pathlib import Path


def main(root):
    sys.path.insert(0, str(root / "studies"))
    import doc_plots

    tables = root / "docs/tables"
    drawn = doc_plots.draw_all()
    present = {path.stem: path.read_text() for path in tables.glob("*.svg")}
    problems = [f"docs/tables/{name}.svg: is not what ./dev studies doc_plots draws" for name in drawn.keys() | present.keys()
                if drawn.get(name) != present.get(name)]
    problems += [f"docs/tables/{path.name}: has no plot" for path in tables.glob("*.csv") if path.stem not in drawn]
    print("\n".join(sorted(problems)) or f"{len(drawn)} plots")
    return bool(problems) or not drawn


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
