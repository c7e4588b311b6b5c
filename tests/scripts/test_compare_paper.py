"""Tests of scripts/benchmarks/compare-paper on tables with known differences from the paper's."""

import csv

from support import DATA, TestCase, run


class ComparePaper(TestCase):
    def setUp(self):
        super().setUp()
        with open(DATA / "zhao2018.csv", encoding="utf-8", newline="") as file:
            self.rows = list(csv.DictReader(file))

    def scale(self, name, **factors):
        row = next(row for row in self.rows if row["id"] == name)
        for key, factor in factors.items():
            row[key] = repr(float(row[key]) * factor)

    def compare(self, *options, code=0):
        path = self.folder / "summary.csv"
        with open(path, "w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, self.rows[0])
            writer.writeheader()
            writer.writerows(self.rows)
        done = run("benchmarks/compare-paper", path, *options)
        self.assertDone(done, code)
        return done

    def test_the_table_agrees_with_itself(self):
        self.assertEqual(len(self.rows), 290)
        output = self.compare().stdout
        self.assertEqual(output.count("290 of 290"), 4)  # atoms, grid, blocks, both
        self.assertNotIn("rows with", output)

    def test_one_row_beyond_the_limit_is_an_error(self):
        self.scale("3dxg", area=1.02)
        done = self.compare(code=1)
        self.assertIn("3dxg differs by 2.0e-02", done.stderr)
        self.assertIn("+2.0e-02", done.stdout)
        self.scale("3dxg", area=1 / 1.02, volume=1 / 1.02)
        self.assertIn("3dxg", self.compare(code=1).stderr)

    def test_median_beyond_the_limit_is_an_error(self):
        for row in self.rows[:200]:
            self.scale(row["id"], area=1.001)
        self.assertIn("median difference in area is 1.0e-03", self.compare(code=1).stderr)
        self.assertIn("1.0e-03", self.compare("--median", "2e-3").stdout)

    def test_rows_with_other_input_are_listed_and_do_not_count(self):
        for row, key in zip(self.rows, ("atoms", "nx")):
            row[key] = str(int(row[key]) + 1)
            self.scale(row["id"], area=1.5)
        output = self.compare().stdout
        self.assertIn("atoms: 289 of 290; grid: 289 of 290; blocks: 290 of 290; "
                      "atoms and grid: 288 of 290", output)
        for row in self.rows[:2]:
            self.assertRegex(output, rf"\n{row['id']} .*\+5\.0e-01")

    def test_ids_with_folders_and_rows_without_results_are_read(self):
        self.rows = self.rows[:3]
        self.rows[0]["id"] = "refined/set/" + self.rows[0]["id"].upper()
        self.rows[1]["atoms"] = self.rows[1]["area"] = ""
        self.rows[2]["id"] = "other"
        self.assertIn("1 of them with results and in the table", self.compare().stdout)

    def test_tables_without_common_rows_are_refused(self):
        self.rows = self.rows[:1]
        self.rows[0]["id"] = "other"
        self.assertIn("no row", self.compare(code=1).stderr)

    def refused(self, text):
        """Returns the message, which must be one line."""
        path = self.folder / "wrong.csv"
        path.write_text(text)
        done = run("benchmarks/compare-paper", path)
        self.assertDone(done, 1)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done.stderr

    def test_empty_files_are_refused(self):
        for text in ("", "\n\n"):
            self.assertIn("wrong.csv: no summary of pdbbind", self.refused(text))
        header, first = (DATA / "zhao2018.csv").read_text().splitlines(keepends=True)[:2]
        self.assertIn("no row has", self.refused(header))
        self.assertIn("no row has", self.refused(header + "\n" + first.replace("3dxg", "other")))

    def test_rows_of_another_length_are_refused(self):
        lines = (DATA / "zhao2018.csv").read_text().splitlines(keepends=True)[:3]
        for row in ("3dxg\n", "3dxg,1856,105\n", lines[2][:-1] + ",1\n"):
            self.assertIn("wrong.csv:3: expected 11 fields, as in the header, found "
                          f"{row.count(',') + 1}\n", self.refused("".join(lines[:2]) + row))

    def test_values_that_are_not_numbers_are_refused(self):
        header, first = (DATA / "zhao2018.csv").read_text().splitlines(keepends=True)[:2]
        area = first.split(",")[8]
        for value in ("", "x", "nan", "inf"):
            self.assertIn("3dxg: ", self.refused(header + first.replace(area, value)))

    def test_files_that_are_not_a_summary_are_refused(self):
        for path in (self.folder / "missing", DATA / "c60.xyzr", "/bin/true"):
            self.assertDone(run("benchmarks/compare-paper", path), 1)

    def test_core_set_agrees_as_documented(self):
        """The rows of data/core-set.csv agree with the paper's as doc/pdbbind.md says, and with
        the differences that the file lists."""
        again = self.folder / "again.csv"
        self.assertDone(run("benchmarks/compare-paper", DATA / "core-set.csv", "-o", again))
        self.assertEqual(again.read_bytes(), (DATA / "core-set.csv").read_bytes())
