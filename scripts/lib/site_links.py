"""Finds links between the pages of a site whose file or anchor is missing: `site_links.py FOLDER`."""

import functools
import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    """The links and anchors of a page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name in ("href", "src") and value:
                self.links.append(value)
            elif name in ("id", "name") and value:
                self.anchors.add(value)


@functools.lru_cache(maxsize=None)
def page_of(path):
    return Page(path)


def broken_links(path, folder):
    for link in page_of(path).links:
        parts = urllib.parse.urlsplit(link)
        if parts.scheme or parts.netloc:
            continue
        target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
        if target.is_dir():
            target /= "index.html"
        if not target.is_file() or not target.is_relative_to(folder):
            yield link
        elif parts.fragment and target.suffix == ".html":
            anchor = urllib.parse.unquote(parts.fragment)
            if anchor not in page_of(target).anchors:
                yield link


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    broken = [f"{path.relative_to(folder)}: {link}" for path in sorted(folder.rglob("*.html"))
              for link in broken_links(path, folder)]
    if broken:
        sys.exit("\n".join(["links that lead nowhere:", *broken]))


if __name__ == "__main__":
    main()
