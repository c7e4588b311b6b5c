"""Tests of the page that scripts/pdbbind --report writes."""

import json
import re
import unittest

from support import PROGRAM, TestCase, browser_errors, has_browser, open_browser, run

RADIUS = 1.7


class Report(TestCase):
    def setUp(self):
        super().setUp()
        structures = self.folder / "structures"
        structures.mkdir()
        for count in (1, 2, 10):  # spheres apart from each other
            (structures / f"n{count}.xyzr").write_text(
                "".join(f"{8 * n} 0 0 {RADIUS}\n" for n in range(count)))
        (structures / "<b>bad.xyzr").write_text("1 2 3 radius\n")
        self.output = self.folder / "out"
        done = run("pdbbind", structures, "-o", self.output, "--program", PROGRAM, "--report",
                   "--keep", "none", "--threads", 1)
        self.assertDone(done, 1)  # one structure has failed
        self.page = self.output / "summary.html"

    def rows(self):
        text = self.page.read_text(encoding="utf-8")
        data = json.loads(re.search(r'id="rows">(.*?)</script>', text, re.DOTALL)[1])
        return [dict(zip(data["columns"], row)) for row in data["rows"]]

    def test_rows_are_those_of_the_structures(self):
        rows = {row["id"]: row for row in self.rows()}
        self.assertEqual({name: row["atoms"] for name, row in rows.items()},
                         {"n1": 1, "n2": 2, "n10": 10, "<b>bad": ""})
        self.assertIn("radius", rows["<b>bad"]["message"])
        self.assertNotIn("<b>", self.page.read_text(encoding="utf-8"))
        written = self.rows()
        done = run("pdbbind", self.folder / "structures", "-o", self.output, "--program", PROGRAM,
                   "--task", "1/1", "--keep", "none", "--threads", 1)
        self.assertDone(done, 1)
        self.page.unlink()
        self.assertDone(run("pdbbind", "merge", self.output, "--report"), 1)
        self.assertEqual([row["id"] for row in self.rows()], [row["id"] for row in written])

    @unittest.skipUnless(has_browser(), "needs chromium, chromium-driver and python3-selenium")
    def test_table_sorts_and_filters(self):
        browser = open_browser(self)
        browser.get(self.page.as_uri())

        def shown(column=0):
            return [row.find_elements("tag name", "td")[column].text
                    for row in browser.find_elements("css selector", "tbody tr")]

        def sort_by(name):
            browser.find_element("xpath", f"//th/button[.='{name}']").click()

        self.assertEqual(set(shown()), {"n1", "n2", "n10", "<b>bad"})
        sort_by("atoms")
        self.assertEqual(shown(), ["n1", "n2", "n10", "<b>bad"])
        sort_by("atoms")
        self.assertEqual(shown(), ["n10", "n2", "n1", "<b>bad"])
        sort_by("id")
        self.assertEqual(shown()[-3:], ["n1", "n2", "n10"])  # numbers in names count as numbers
        browser.find_element("id", "filter").send_keys("n1")
        self.assertEqual(shown(), ["n1", "n10"])
        self.assertEqual(browser.find_element("id", "shown").text, "2 of 4 structures")
        self.assertIn("<b>bad: ", browser.find_element("id", "failures").text)
        # A dot for each structure with an area: as many pixels as circles have.
        blue = browser.execute_script("""
          const canvas = document.getElementById("plot-area"), pen = canvas.getContext("2d");
          const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
          let count = 0;
          for (let i = 0; i < data.length; i += 4)
            if (data[i + 2] > data[i] + 100 && data[i + 3] > 127) count++;
          return count""")
        self.assertAlmostEqual(blue, 2 * 3.14 * 2.5**2, delta=12)
        self.assertEqual(browser_errors(browser), [])


if __name__ == "__main__":
    unittest.main()
