"""Runs the example notebooks and renders them as Markdown, for make-notebook and the tests.

Needs nbclient, nbformat and ipykernel.
"""

import base64
import os
import pathlib
import sys

import nbclient
import nbformat

PROJECT = pathlib.Path(__file__).resolve().parents[2]

# Names of the pages in doc/ by the names of the notebooks in python/examples/.
PAGES = {"surface": "notebook", "interface": "notebook-interface", "trajectory": "notebook-trajectory",
         "potential": "notebook-potential"}


def source_of(name):
    return PROJECT / f"python/examples/{name}.ipynb"


def page_of(name):
    return PROJECT / f"doc/{PAGES[name]}.md"


def picture_of(name, number):
    """Returns the file of a picture, which is beside the page. Numbers start from 1."""
    return page_of(name).with_name(f"{PAGES[name]}-{number}.png")


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


def pictures_in(notebook):
    """Returns the outputs that are pictures in Markdown, in order: a page with a surface as HTML, a plot as bytes."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ()) if is_page(output) or is_plot(output)]
    return [output.data["text/html"] if is_page(output) else base64.b64decode(output.data["image/png"])
            for output in outputs]


def is_page(output):
    return "<iframe srcdoc=" in output.get("data", {}).get("text/html", "")


def is_plot(output):
    return "image/png" in output.get("data", {})


def markdown(name, notebook):
    """Returns the notebook as Markdown, with a picture in place of each page and plot."""
    parts = [f"<!-- scripts/dev/make-notebook has made this page from {source_of(name).relative_to(PROJECT)}. -->"]
    pictures = 0
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for output in cell.outputs:
            if is_page(output) or is_plot(output):
                pictures += 1
                what = "The page with the surface, as the notebook shows it" if is_page(output) else "The plot of this cell"
                parts.append(f"![{what}]({picture_of(name, pictures).name})")
            elif output.get("name") != "stderr":  # its warnings depend on the versions of other packages
                text = output.text if output.output_type == "stream" else output.data["text/plain"]
                parts.append(f"```text\n{text.rstrip()}\n```")
    return "\n\n".join(parts) + "\n"
