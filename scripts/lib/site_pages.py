"""Collects the sources of the site, for make-site: `site_pages.py FOLDER`.

FOLDER receives README.md, the pages of doc/, every file that they link to, under the same relative paths, and pages for
the references of Python and C++. doc/README.md gives the order of the pages.
"""

import pathlib
import re
import shutil
import sys
import urllib.parse

PROJECT = pathlib.Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^()\s]+)\)")
# Modules that need no other library.
MODULES = ("eses_blocks", "eses_blocks.adaptors")


def linked_files(path):
    """Returns the files of the project to which a page links. Throws ValueError if one is missing."""
    text = re.sub(r"`[^`\n]*`", "", FENCE.sub("", path.read_text(encoding="utf-8")))
    found = []
    for link in LINK.findall(text):
        parts = urllib.parse.urlsplit(link)
        if parts.scheme or not parts.path:
            continue
        target = (path.parent / urllib.parse.unquote(parts.path)).resolve()
        if not target.is_file() or not target.is_relative_to(PROJECT):
            raise ValueError(f"{path}: the link {link} is not a file of the project")
        found.append(target)
    return found


def collect(folder):
    """Copies the pages and all files that they link to. Returns the names of the pages."""
    waiting = [PROJECT / "README.md", *sorted((PROJECT / "doc").glob("*.md"))]
    done = set()
    while waiting:
        path = waiting.pop()
        if path in done:
            continue
        done.add(path)
        target = folder / path.relative_to(PROJECT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
        if path.suffix == ".md":
            waiting += linked_files(path)
    return sorted(str(path.relative_to(PROJECT)) for path in done if path.suffix == ".md")


def contents():
    """Returns headings and pages of doc/README.md."""
    text = (PROJECT / "doc/README.md").read_text(encoding="utf-8")
    sections = []
    for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        title, _, body = section.partition("\n")
        pages = [(PROJECT / "doc" / name).resolve().relative_to(PROJECT).as_posix()
                 for name in re.findall(r"^\| \[[^]]*\]\(([^)#]+)\)", body, re.MULTILINE)]
        sections.append((title.strip(), pages))
    return sections


def write_toctree(folder, names):
    """Appends the contents to the first page, and marks all other pages as such."""
    seen, text = {"README.md"}, ""
    for title, pages in [("", ["doc/README.md"]), *contents(), ("Reference", ["reference/python.md", "reference/cpp.md"])]:
        new = [page for page in pages if page not in seen]
        seen.update(new)
        caption = f":caption: {title}\n" if title else ""
        text += f"\n```{{toctree}}\n:hidden:\n{caption}\n" + "".join(f"/{page[:-3]}\n" for page in new) + "```\n"
    with open(folder / "README.md", "a", encoding="utf-8") as target:
        target.write(text)
    for name in set(names) - seen:
        path = folder / name
        path.write_text("---\norphan: true\n---\n" + path.read_text(encoding="utf-8"), encoding="utf-8")


def write_references(folder):
    (folder / "reference").mkdir()
    parts = ["# Reference of the Python package\n\nThe pages [python.md](../doc/python.md) and "
             "[molecules.md](../doc/molecules.md) have examples.\n"]
    parts += [f"## {name}\n\n```{{eval-rst}}\n.. automodule:: {name}\n   :members:\n   :imported-members:\n"
              f"   :undoc-members:\n```\n" for name in MODULES]
    (folder / "reference/python.md").write_text("\n".join(parts), encoding="utf-8")
    rows = ["# Reference of the C++ library\n\nThe page [library.md](../doc/library.md) has examples. The "
            "<a href=\"cpp/index.html\">pages made by Doxygen</a> describe all functions and types of the headers:\n",
            "| header | content |\n|---|---|"]
    for header in sorted((PROJECT / "include/eses").glob("*.hpp")):
        brief = re.search(r"@file\n/// (.*?)(?:\n(?!///)|\n///\n)", header.read_text(encoding="utf-8"), re.DOTALL)
        text = " ".join(brief[1].replace("///", "").split()) if brief else ""
        # Doxygen's name of the page of a file.
        name = re.sub("[A-Z]", lambda letter: "_" + letter[0].lower(), header.stem.replace("_", "__")) + "_8hpp.html"
        rows.append(f"| <a href=\"cpp/{name}\"><code>eses/{header.name}</code></a> | {text} |")
    (folder / "reference/cpp.md").write_text("\n".join(rows) + "\n", encoding="utf-8")


def main():
    folder = pathlib.Path(sys.argv[1])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        names = collect(folder)
    except ValueError as error:
        sys.exit(f"site_pages.py: {error}")
    write_references(folder)
    write_toctree(folder, names)


if __name__ == "__main__":
    main()
