"""Runs the Python examples of doc/python.md, doc/molecules.md and the package as doctests."""

import doctest
import shutil

import pytest

import eses_blocks as eses
from conftest import DATA, PROJECT

FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@pytest.fixture(autouse=True)
def in_folder_with_data(tmp_path, monkeypatch):
    for name in ("1ubq.xyzr", "fas2.pqr"):
        shutil.copy(DATA / name, tmp_path)
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(("name", "least"), [("python.md", 20), ("molecules.md", 10)])
def test_examples_of_the_page_run(name, least, monkeypatch):
    monkeypatch.setattr(eses.adaptors, "ADAPTORS", dict(eses.adaptors.ADAPTORS))
    page = PROJECT / "doc" / name
    # The end of a code block would count as expected output.
    text = page.read_text(encoding="utf-8").replace("```\n", "\n")
    examples = doctest.DocTestParser().get_doctest(text, {"__name__": "doctest"}, page.name, str(page), 0)
    assert len(examples.examples) > least
    report = []
    results = doctest.DocTestRunner(optionflags=FLAGS).run(examples, out=report.append)
    assert results.failed == 0, "".join(report)


def test_examples_of_the_package_run():
    results = doctest.testmod(eses, optionflags=FLAGS)
    assert results.attempted > 3 and results.failed == 0
