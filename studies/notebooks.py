# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""notebooks.py NOTEBOOK...: runs Jupyter notebooks and stores their outputs in them. PYTHONPATH must lead to the built module palpate.

Nothing of the machine or the time is stored, so that a notebook changes only if its outputs do.
"""
import os
import sys
import tempfile
from pathlib import Path
from unittest import mock

import nbformat
from nbclient import NotebookClient

LONGEST_CELL = 120  # s
os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # Jupyter's debugger warns of Python's own modules


def joined(outputs):
    """The outputs with the pieces of one text together: where a text is cut depends on the time."""
    whole = []
    for output in outputs:
        if whole and output.output_type == whole[-1].output_type == "stream" and output.name == whole[-1].name:
            whole[-1].text += output.text
        else:
            whole.append(output)
    return whole


def run(path):
    """The notebook with the outputs of a run in its folder."""
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as home:  # no settings of the user, and nothing left behind
        settings = {"IPYTHONDIR": home, "JUPYTER_CONFIG_DIR": home, "JUPYTER_RUNTIME_DIR": home,
                    "MPLBACKEND": "module://matplotlib_inline.backend_inline"}
        with mock.patch.dict(os.environ, settings):
            NotebookClient(notebook, timeout=LONGEST_CELL, record_timing=False, kernel_name="python3",
                           resources={"metadata": {"path": str(path.parent)}}).execute()
    notebook.metadata.language_info = {"name": "python"}
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = joined(cell.outputs)
    return notebook


if __name__ == "__main__":
    for argument in sys.argv[1:]:
        nbformat.write(run(Path(argument)), argument)
