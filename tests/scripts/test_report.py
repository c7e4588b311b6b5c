"""Tests of the pages that scripts/pdbbind --report and scripts/report write."""

import base64
import json
import math
import re
import struct
import subprocess
import unittest

from support import (PROGRAM, TestCase, accessibility_faults, browser_errors, can_draw,
                     has_browser, open_browser, run)

RADIUS = 1.7


def data_of(page):
    text = page.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="rows">(.*?)</script>', text, re.DOTALL)[1])


def rows_of(page):
    data = data_of(page)
    return [dict(zip(data["columns"], row)) for row in data["rows"]]


def size_of(address):
    """Returns width and height of a PNG picture in a page."""
    data = base64.b64decode(address.removeprefix("data:image/png;base64,"), validate=True)
    return struct.unpack(">II", data[16:24])


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

    def test_rows_are_those_of_the_structures(self):
        rows = {row["id"]: row for row in rows_of(self.page)}
        self.assertEqual({name: row["atoms"] for name, row in rows.items()},
                         {"n1": 1, "n2": 2, "n10": 10, "<b>bad": ""})
        self.assertIn("radius", rows["<b>bad"]["message"])
        self.assertNotIn("<b>", self.page.read_text(encoding="utf-8"))
        written = rows_of(self.page)
        done = run("pdbbind", self.folder / "structures", "-o", self.output, "--program", PROGRAM,
                   "--task", "1/1", "--keep", "none", "--threads", 1)
        self.assertDone(done, 1)
        self.page.unlink()
        self.assertDone(run("pdbbind", "merge", self.output, "--report"), 1)
        self.assertEqual([row["id"] for row in rows_of(self.page)], [row["id"] for row in written])

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
        # A dot for each structure with an area.
        path = browser.find_element("css selector", "#plots-area .points").get_attribute("d")
        self.assertEqual(path.count("M"), 2)
        self.assertEqual(accessibility_faults(browser), [])
        self.assertEqual(browser_errors(browser), [])

    @unittest.skipUnless(can_draw(), "needs python3-vtk9 and a display or xvfb")
    def test_chosen_structures_have_pictures(self):
        def compute(patterns):
            self.assertDone(run("pdbbind", self.folder / "structures", "-o", self.output,
                                "--program", PROGRAM, "--report", "--keep", "none", "--threads", 1,
                                "--pictures", patterns), 1)
            return data_of(self.page)["pictures"]

        pictures = compute("n1*")  # n2 is complete
        self.assertEqual(set(pictures), {"n1", "n10"})
        self.assertEqual({size_of(address) for address in pictures.values()}, {(320, 240)})
        self.assertEqual(set(compute("n2")), {"n1", "n2", "n10"})


class MeasureReport(TestCase):
    """Spheres that are apart from each other, whose areas and volumes are known."""

    def setUp(self):
        super().setUp()
        for count in (1, 2):
            (self.folder / f"n{count}.xyzr").write_text(
                "".join(f"{8 * n} 0 0 {RADIUS}\n" for n in range(count)))
        (self.folder / "bad.xyzr").write_text("1 2 3 radius\n")
        self.page = self.folder / "page.html"

    def measure(self, *options):
        return subprocess.run([PROGRAM, "measure", "n1.xyzr", "bad.xyzr", "n2.xyzr", *options],
                              cwd=self.folder, capture_output=True, text=True, check=False)

    def test_tables_and_json_give_the_same_page(self):
        table, lines, errors = (self.folder / name for name in ("a.csv", "a.json", "errors.txt"))
        errors.write_text(self.measure("--csv", table).stderr)
        lines.write_text(self.measure("--json").stdout)
        for source in (table, lines):
            self.assertDone(run("report", source, "--messages", errors, "-o", self.page))
            *spheres, failed = rows_of(self.page)
            for count, row in enumerate(spheres, 1):
                self.assertEqual((row["file"], row["atoms"], row["status"]),
                                 (f"n{count}.xyzr", count, "done"))
                self.assertAlmostEqual(row["ses_area"], count * 4 * math.pi * RADIUS**2, places=5)
                self.assertAlmostEqual(row["convex_area"], row["ses_area"], places=5)
                self.assertAlmostEqual(row["ses_volume"], count * 4 / 3 * math.pi * RADIUS**3,
                                       places=5)
            self.assertEqual(failed["status"], "failed")
            self.assertIn("bad.xyzr:1: field 4 (radius)", failed["message"])
            data = data_of(self.page)
            self.assertEqual([name for name, _ in data["plots"]], ["ses_area", "sas_area", "ses_volume"])
            self.assertEqual(data["texts"], ["file", "status", "message"])

    def test_rows_of_models_have_their_number_first(self):
        table = self.folder / "m.csv"
        for files, first in (("aa", ["file", "model"]), ("ab", ["file", "atoms"])):
            table.write_text("file,atoms,ses_area,model,error\n" + "".join(
                f"{name}.pdb,3,10,{number}," + "\n" for number, name in enumerate(files, 1)))
            self.assertDone(run("report", table, "-o", self.page))
            self.assertEqual(data_of(self.page)["columns"][:2], first)

    @unittest.skipUnless(has_browser(), "needs chromium, chromium-driver and python3-selenium")
    def test_many_files_at_a_glance(self):
        """Plots fit their values, outliers are named, and the table is downloaded as it is shown."""
        table = self.folder / "a.csv"
        values = [(f"s{n}.pdb", 1000 + 37 * n, 50 * (1000 + 37 * n) * (3 if n == 7 else 1 + 0.01 * (n % 3)))
                  for n in range(40)]
        table.write_text("file,atoms,ses_area,error\n"
                         + "".join(f"{name},{atoms},{area:.6f},\n" for name, atoms, area in values))
        self.assertDone(run("report", table, "-o", self.page))
        browser = open_browser(self)
        browser.get(self.page.as_uri())
        self.assertEqual(len(browser.find_elements("css selector", "#plots-ses_area .outlier")), 1)
        titles = browser.execute_script(
            "return ['sas_volume', 'vdw_area', 'euler_number', 'cavities'].map(titleOf)")
        self.assertEqual(titles, ["SAS volume, Å³", "vdw area, Å²", "Euler number", "cavities"])
        outliers = [item.text for item in browser.find_elements("css selector", "#outliers li")]
        self.assertEqual(len(outliers), 1)
        self.assertRegex(outliers[0], r"^s7\.pdb: SES area 2\.9\d* times the expected$")
        # Less than a decade has several labels, and points fill most of the plot.
        labels = browser.execute_script(
            "return Array.from(document.querySelectorAll('#plots-ses_area text:not(.title)'), (e) => e.textContent)")
        self.assertGreater(len(labels), 6)
        box = browser.execute_script("const b = document.querySelector('#plots-ses_area .points').getBBox(); "
                                     "return [b.width, b.height]")
        self.assertGreater(box[0], 200)
        self.assertGreater(box[1], 100)
        clipped = browser.execute_script("""
          return Array.from(document.querySelectorAll("svg text"), (text) => {
            const box = text.getBBox(), all = text.ownerSVGElement.viewBox.baseVal;
            return box.x < 0 || box.y < 0 || box.x + box.width > all.width + 0.5 || box.y + box.height > all.height + 0.5
              ? text.textContent : "";
          }).filter((text) => text)""")
        self.assertEqual(clipped, [])
        self.assertEqual(len(browser.find_elements("css selector", "#histograms-ses_area .bars")), 1)
        browser.find_element("css selector", "#outliers button").click()
        self.assertEqual(browser.find_element("id", "shown").text, "1 of 40 structures")
        browser.execute_script("URL.createObjectURL = (blob) => { blob.text().then((text) => { window.saved = text; }); "
                               "return '#'; };")
        browser.find_element("id", "download").click()
        saved = browser.execute_async_script("const [done] = arguments; setTimeout(() => done(window.saved), 100)")
        self.assertEqual(saved.splitlines()[0], "file,atoms,ses_area,status,message")
        self.assertEqual(saved.splitlines()[1:], [f"s7.pdb,1259,{values[7][2]:g},done,"])
        self.assertEqual(browser_errors(browser), [])

    @unittest.skipUnless(has_browser(), "needs chromium, chromium-driver and python3-selenium")
    def test_printed_and_narrow_pages_have_no_clipped_parts(self):
        table = self.folder / "a.csv"
        self.measure("--csv", table)
        self.assertDone(run("report", table, "-o", self.page))
        browser = open_browser(self)
        for media, width in (("print", 1032), ("screen", 360)):
            browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media})
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": 700, "deviceScaleFactor": 1, "mobile": False})
            browser.get(self.page.as_uri())
            self.assertLessEqual(browser.execute_script("return document.documentElement.scrollWidth"), width)
            if media == "print":
                region = "document.querySelector('.scroll')"
                self.assertLessEqual(browser.execute_script(f"return {region}.scrollWidth - {region}.clientWidth"), 0)
                self.assertFalse(browser.find_element("id", "download").is_displayed())

    def test_other_files_are_refused(self):
        table = self.folder / "a.csv"
        for text in ("", "a,b\n1,2\n", "{}\n", "{\n", "file,name\na,b\n"):
            table.write_text(text)
            done = run("report", table, "-o", self.page)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"{table}: no table of eses-blocks measure", done.stderr)
            self.assertFalse(self.page.exists())
        for text, message in (("file,atoms\n1\n", ":2: expected 2 fields, found 1; the table seems to be cut off"),
                              ("file,atoms\na,1\nb,2,3\n", ":3: expected 2 fields, found 3"),
                              ("file;atoms\na;1\n", ": the columns must be separated by commas"),
                              ("file\tatoms\na\t1\n", ": the columns must be separated by commas")):
            table.write_text(text)
            done = run("report", table, "-o", self.page)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"{table}{message}", done.stderr)
        table.write_text("file,atoms\na,1\n")
        done = run("report", table, "-o", self.page, "--", "--radii", "bondi")
        self.assertEqual(done.returncode, 2)
        self.assertIn("need --pictures", done.stderr)

    def test_texts_of_spreadsheets_are_read(self):
        """They begin with the byte order mark, and may be UTF-16. Names of structures may be long."""
        table, pages = self.folder / "a.csv", []
        text = f"file,atoms\n{'ä' * 200000},1\n"
        for encoding in ("utf-8", "utf-8-sig", "utf-16"):
            table.write_bytes(text.encode(encoding))
            self.assertDone(run("report", table, "-o", self.page))
            pages.append(self.page.read_text(encoding="utf-8"))
        self.assertEqual(pages[1:], pages[:1] * 2)

    @unittest.skipUnless(can_draw(), "needs python3-vtk9 and a display or xvfb")
    def test_chosen_files_have_pictures(self):
        table = self.folder / "a.csv"
        self.measure("--csv", table)
        done = run("report", table, "-o", self.page, "--program", PROGRAM, "--pictures", "n2*")
        self.assertDone(done)
        (name, address), = data_of(self.page)["pictures"].items()
        self.assertEqual((name, size_of(address)), ("n2.xyzr", (320, 240)))
        (self.folder / "n2.xyzr").unlink()
        done = run("report", table, "-o", self.page, "--program", PROGRAM, "--pictures", "n2*")
        self.assertDone(done)
        self.assertIn("n2.xyzr: no picture: ", done.stderr)
        self.assertEqual(data_of(self.page)["pictures"], {})
        self.assertIn("no file of the table matches",
                      run("report", table, "-o", self.page, "--pictures", "n3").stderr)

    @unittest.skipUnless(has_browser(), "needs chromium, chromium-driver and python3-selenium")
    def test_page_shows_failures(self):
        table, errors = self.folder / "a.csv", self.folder / "errors.txt"
        errors.write_text(self.measure("--csv", table).stderr)
        self.assertDone(run("report", table, "--messages", errors, "-o", self.page))
        browser = open_browser(self)
        browser.get(self.page.as_uri())
        self.assertIn("3 structures: 2 done, 1 failed",
                      browser.find_element("tag name", "body").text)
        self.assertTrue(browser.find_element("id", "failures").text.endswith('found "radius"'))
        self.assertEqual(browser_errors(browser), [])


if __name__ == "__main__":
    unittest.main()
