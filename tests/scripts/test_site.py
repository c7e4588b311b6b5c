"""Tests of the sources of the site."""

import subprocess
import sys
import unittest

from support import PROJECT, SCRIPTS, TestCase


class Site(TestCase):
    def test_pages_and_what_they_link_to_are_collected(self):
        folder = self.folder / "pages"
        done = subprocess.run([sys.executable, SCRIPTS / "lib/site_pages.py", folder], capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((folder / "doc/grid.md").read_bytes(), (PROJECT / "doc/grid.md").read_bytes())
        index = (folder / "README.md").read_text(encoding="utf-8")
        for path in sorted((PROJECT / "doc").glob("*.md")):
            self.assertIn(f"\n/doc/{path.stem}\n", index)
        self.assertIn("orphan: true", (folder / "src/run/README.md").read_text(encoding="utf-8"))
        headers = (folder / "reference/cpp.md").read_text(encoding="utf-8")
        self.assertIn('<a href="cpp/measure__frames_8hpp.html"><code>eses/measure_frames.hpp</code></a> | ', headers)
        self.assertNotIn("</a> |  |", headers)  # every header has a description


if __name__ == "__main__":
    unittest.main()
