"""Executes a notebook in its folder, and tells what each of its cells printed last."""

import sys

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

path = sys.argv[1]
notebook = nbformat.read(path, as_version=4)
try:
    # The kernel of this interpreter, whatever kernels are installed.
    client = NotebookClient(notebook, timeout=600, kernel_name="python3")
    client.execute()
except CellExecutionError as error:
    print(f"FAIL {path}\n{error}", file=sys.stderr)
    sys.exit(1)
if len(sys.argv) > 2:
    nbformat.write(notebook, sys.argv[2])
cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
figures = sum("image/png" in out.get("data", {}) for cell in cells for out in cell.outputs)
print(f"ok   {path}: {len(cells)} cells, {figures} figures")
