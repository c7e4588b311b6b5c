"""Tests of the sources of the site and of the search for links that lead nowhere."""

import subprocess
import sys
import unittest

from support import PROJECT, SCRIPTS, TestCase


def run(script, folder):
    return subprocess.run([sys.executable, SCRIPTS / "lib" / script, folder], capture_output=True, text=True, check=False)


class Site(TestCase):
    def test_pages_and_what_they_link_to_are_collected(self):
        folder = self.folder / "pages"
        done = run("site_pages.py", folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((folder / "doc/grid.md").read_bytes(), (PROJECT / "doc/grid.md").read_bytes())
        index = (folder / "README.md").read_text(encoding="utf-8")
        for path in sorted((PROJECT / "doc").glob("*.md")):
            self.assertIn(f"\n/doc/{path.stem}\n", index)
        self.assertIn("orphan: true", (folder / "src/run/README.md").read_text(encoding="utf-8"))
        headers = (folder / "reference/cpp.md").read_text(encoding="utf-8")
        self.assertIn('<a href="cpp/measure__frames_8hpp.html"><code>eses/measure_frames.hpp</code></a> | ', headers)
        self.assertNotIn("</a> |  |", headers)  # every header has a description

    def test_links_that_lead_nowhere_are_found(self):
        (self.folder / "one.html").write_text('<h1 id="a"></h1><a href="two.html#b">x</a><a href="#a">y</a>'
                                              '<a href="https://example.org/z">z</a>')
        (self.folder / "two.html").write_text('<p id="b"><img src="gone.png"><a href="one.html#c">w</a>')
        done = run("site_links.py", self.folder)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.splitlines()[1:], ["two.html: gone.png", "two.html: one.html#c"])
        (self.folder / "two.html").write_text('<p id="b">')
        self.assertEqual(run("site_links.py", self.folder).returncode, 0)


if __name__ == "__main__":
    unittest.main()
