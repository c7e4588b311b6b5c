"""Runs the example notebook and renders it as Markdown, for make-notebook and the tests.

Needs nbclient, nbformat and ipykernel.
"""

import os
import pathlib
import sys

import nbclient
import nbformat

PROJECT = pathlib.Path(__file__).resolve().parents[2]

SOURCE = PROJECT / "python/examples/surface.ipynb"
PAGE = PROJECT / "doc/notebook.md"
PICTURE = "notebook-{}.png"  # beside the page


def run(path, folder):
    """Returns the notebook with its outputs. It runs in `folder`, in which data/ of the project is
    not, with this interpreter and its PYTHONPATH."""
    notebook = nbformat.read(path, as_version=4)
    sources = [cell.source for cell in notebook.cells]
    for cell in notebook.cells:
        cell.source = cell.source.replace("../../data", str(PROJECT / "data"))
    # The kernel of this interpreter, whatever kernels the user has.
    os.environ["JUPYTER_PATH"] = str(pathlib.Path(sys.prefix) / "share/jupyter")
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": folder}}).execute()
    for cell, source in zip(notebook.cells, sources):
        cell.source = source
    return notebook


def pages_in(notebook):
    """Returns the outputs that are pages with a surface, as HTML."""
    return [output.data["text/html"] for cell in notebook.cells for output in cell.get("outputs", ())
            if is_page(output)]


def is_page(output):
    return "<iframe srcdoc=" in output.get("data", {}).get("text/html", "")


def markdown(notebook):
    """Returns the notebook as Markdown, with a picture in place of each page."""
    parts = [f"<!-- scripts/dev/make-notebook has made this page from {SOURCE.relative_to(PROJECT)}. -->"]
    pictures = 0
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for output in cell.outputs:
            if is_page(output):
                pictures += 1
                parts.append(f"![The page with the surface, as the notebook shows it]"
                             f"({PICTURE.format(pictures)})")
            else:
                text = output.text if output.output_type == "stream" else output.data["text/plain"]
                parts.append(f"```text\n{text.rstrip()}\n```")
    return "\n\n".join(parts) + "\n"
