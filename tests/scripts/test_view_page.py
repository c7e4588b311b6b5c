"""Tests of the pages of scripts/view in headless Chromium. They are skipped without Chromium and
python3-selenium. Expected colours, areas and names come from the input and from geometry.
"""

import itertools
import json
import math
import subprocess
import unittest

from support import (PROGRAM, TestCase, accessibility_faults, browser_errors, can_import, has_browser,
                     open_browser, write_map)
from test_view import RADIUS, SCRIPT, TWO_ATOMS, run_view


@unittest.skipUnless(has_browser() and can_import(SCRIPT, "numpy"),
                     "needs chromium, chromium-driver, python3-selenium and python3-numpy")
class Page(TestCase):
    def setUp(self):
        super().setUp()
        self.browser = open_browser(self)
        self.atoms = self.folder / "two.pqr"
        self.atoms.write_text(TWO_ATOMS)

    def open(self, *arguments):
        page = self.folder / "page.html"
        self.assertDone(run_view("--spacing", "0.6", *arguments, "-o", page))
        self.browser.get(page.as_uri())
        self.ask("viewer.set('theme', 'light'); viewer.set('shading', false);"
                 "viewer.lookAlong(2)")  # x to the right, y upwards

    def ask(self, script):
        """Runs a script in the page with its viewer and returns the result."""
        return self.browser.execute_async_script(
            "const [done] = arguments;"
            f"window.eses.then((viewer) => {{ {script} }}).then(done, (e) => done('' + e.stack))")

    def bytes_of_picture(self, script):
        """Draws, and runs a script with the red, green, blue and alpha of all pixels as `bytes`."""
        return self.ask("""
          viewer.draw();
          const { gl } = viewer, { width, height } = viewer.buffers;
          const bytes = new Uint8Array(4 * width * height);
          gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
          """ + script)

    def pixels(self):
        """Returns the number of pixels that are near each hue of the picture, and others."""
        return self.bytes_of_picture("""
          const counts = {};
          for (let i = 0; i < bytes.length; i += 4) {
            const [r, g, b] = bytes.subarray(i, i + 3);
            const name = Math.max(r, g, b) - Math.min(r, g, b) < 12 ? (r > 250 ? "white" : "grey")
              : r > g && r > b ? (g > 1.5 * b ? "orange" : "red") : g > b ? "green" : "blue";
            counts[name] = (counts[name] ?? 0) + 1;
          }
          return counts""")

    def test_colours_and_sizes_of_spheres(self):
        self.open(self.atoms, "--color", "patch")
        found = self.pixels()
        area = self.ask("return viewer.scaleIn(viewer.buffers.width, viewer.buffers.height)")**2
        # Two discs of convex patches, and a white background.
        self.assertAlmostEqual(found["blue"] / (2 * math.pi * RADIUS**2 * area), 1, delta=0.05)
        self.assertEqual(set(found) - {"grey"}, {"blue", "white"})
        # Chains A and B have the colours of the numbers 0 and 1 of eses-blocks: red and blue.
        self.ask("viewer.set('color', 'chain')")
        found = self.pixels()
        self.assertAlmostEqual(found["red"] / (math.pi * RADIUS**2 * area), 1, delta=0.06)
        self.assertAlmostEqual(found["blue"] / (math.pi * RADIUS**2 * area), 1, delta=0.06)
        # The clip plane at the centre leaves the inner half; the whole depth leaves nothing.
        self.ask("viewer.set('clip', 100)")
        self.assertEqual(set(self.pixels()), {"white"})

    def test_borders_of_chains_are_sharp(self):
        """Between red and blue there is hardly any pixel with a colour between them."""
        self.atoms.write_text(TWO_ATOMS.replace("-6 0 0", "-1.5 0 0").replace(" 6 0 0", " 1.5 0 0"))
        self.open(self.atoms, "--color", "chain")
        colored, between = self.bytes_of_picture("""
          let colored = 0, between = 0;
          for (let i = 0; i < bytes.length; i += 4) {
            const [r, g, b] = bytes.subarray(i, i + 3);
            if (Math.max(r, g, b) - Math.min(r, g, b) < 40) continue;
            colored++;
            // Red has b = g; blue has r = g, but for its hue of 222 degrees.
            if (Math.min(r, b) > g + 0.25 * (Math.max(r, b) - g)) between++;
          }
          return [colored, between]""")
        self.assertGreater(colored, 20000)
        self.assertLess(between / colored, 0.015)

    def test_heights_of_colours_do_not_end_in_thin_triangles(self):
        """The colour of such a height, within a quarter of the highest one, would be seen as a line."""
        self.atoms.write_text(TWO_ATOMS.replace("-6 0 0", "-1.5 0.1 0").replace(" 6 0 0", " 1.5 0.1 0"))
        self.open(self.atoms, "--spacing", "0.23")
        for scheme in ("chain", "patch"):
            short, ended = self.ask(f"""
              const molecule = viewer.molecules[0], counts = [0, 0];
              const bytes = paintVertices(molecule, "{scheme}", viewer.limits, false);
              const at = (vertex) => molecule.points.subarray(3 * vertex, 3 * vertex + 3);
              forEdges(molecule.triangle, (one, other) => {{
                if (Math.hypot(...at(one).map((value, axis) => value - at(other)[axis])) > 0.08) return;
                counts[0]++;
                for (let kind = 3; kind < 16; kind += 4)
                  if (bytes[16 * one + kind] > 191 && bytes[16 * other + kind] === 0) counts[1]++;
              }});
              return counts""")
            self.assertGreater(short, 500)
            self.assertEqual(ended, 0, scheme)

    def test_slow_pictures_are_noticed_by_their_mean_time(self):
        """Browsers ask for pictures before those before them are drawn: 17 and 1000 ms alternate."""
        self.open(self.atoms)
        self.ask("viewer.isSlow = false; viewer.isChanging = true; viewer.waitForRest = () => {};"
                 "const now = performance.now();"
                 "viewer.frames = [2034, 2017, 1017, 1000].map((age) => now - age); viewer.update()")
        self.wait_for("return window.eses.then((viewer) => viewer.isSlow)", True)

    def write_block(self, *shape, hole=()):
        """Writes a block of atoms of alanine, and an ion in the hole or behind the block."""
        places = [(x, y, z) for x in range(shape[0]) for y in range(shape[1]) for z in range(shape[2]) if (x, y, z) != hole]
        ion = hole or (shape[0] // 2, shape[1] // 2, -2)
        self.atoms.write_text("".join(
            "ATOM {} {} {} A {} {} {} {} 0 {}\n".format(n, *("CA ALA".split() if n <= len(places) else "ZN ZN".split()), n,
                                                        *(2.5 * value for value in place), 1.8)
            for n, place in enumerate([*places, ion], 1)))

    def test_first_views_show_ligands(self):
        """An ion behind a wall is seen from the other side, and has its label only there."""
        labels = "document.querySelectorAll('#labels div:not([hidden])').length"
        self.write_block(9, 6, 1)
        self.open(self.atoms)
        self.assertEqual(self.ask(f"viewer.reset(); viewer.draw(); return [viewer.look.opacity, seenLigands(viewer)[0].size, {labels}]"), [100, 1, 1])
        self.assertEqual(self.ask(f"viewer.turn(0, Math.PI); viewer.isChanging = false; viewer.draw(); return {labels}"), 0)
        self.assertEqual(self.ask(f"viewer.set('opacity', 50); viewer.draw(); return {labels}"), 1)

    def test_buried_ligands_are_seen_through_the_surface(self):
        self.write_block(5, 5, 5, hole=(2, 2, 2))
        for arguments, opacity in (((), 45), (("--opacity", "100"), 100)):
            self.open(self.atoms, *arguments)
            self.assertEqual(self.ask("return viewer.look.opacity"), opacity)

    def test_labels_do_not_cover_each_other(self):
        self.atoms.write_text(TWO_ATOMS + "".join(
            f"ATOM {n} ZN ZN C {n} {0.1 * n} 9 0 0 0.7\n" for n in range(3, 8)))
        self.open(self.atoms)
        boxes = self.ask("return Array.from(document.querySelectorAll('#labels div:not([hidden])'), (one) =>"
                         "Object.values(one.getBoundingClientRect().toJSON()))")
        self.assertEqual(len(boxes), 2)  # above and below; three others would cover them
        self.assertNotEqual(boxes[0][1], boxes[1][1])
        self.assertGreaterEqual(abs(boxes[0][1] - boxes[1][1]), boxes[0][3])

    def test_borders_of_patches_are_exact(self):
        """Between two atoms, the saddle ends where the probe leaves the contact circle."""
        half, probe = 1.6, 1.4
        self.atoms.write_text(TWO_ATOMS.replace("-6 0 0", f"{-half} 0 0").replace(" 6 0 0", f" {half} 0 0"))
        self.open(self.atoms, "--color", "patch")
        ends = self.bytes_of_picture("""
          const scale = viewer.scaleIn(width, height), ends = [];
          for (let y = Math.round(height / 2 - 0.8 * scale); y < height / 2 + 0.8 * scale; y++) {
            const saddle = [];
            for (let x = 0; x < width; x++) {
              const [r, g, b] = bytes.subarray(4 * (y * width + x));
              if (r > 1.2 * b && g > 1.2 * b) saddle.push((x + 0.5 - width / 2) / scale);
            }
            ends.push(saddle[0], saddle[saddle.length - 1]);
          }
          return ends""")
        border = half * probe / (RADIUS + probe)
        self.assertGreater(len(ends), 100)
        self.assertLess(max(abs(abs(end) - border) for end in ends), 0.06)

    def test_potential_is_red_where_negative_and_blue_where_positive(self):
        field = write_map(self.folder / "x.dx", 5)
        self.open(self.atoms, "--potential", field)
        left, right = self.ask("""
          viewer.draw();
          const { gl } = viewer, { width, height } = viewer.buffers;
          const scale = viewer.scaleIn(width, height), pixel = new Uint8Array(4);
          return [-6, 6].map((x) => {
            gl.readPixels(width / 2 + scale * x, height / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
            return Array.from(pixel);
          })""")
        self.assertGreater(left[0], left[2] + 80)
        self.assertGreater(right[2], right[0] + 80)
        self.assertIn("kT/e", self.browser.find_element("id", "legend").text)

    def test_pointing_names_the_atom(self):
        from selenium.webdriver import ActionChains
        self.open(self.atoms)
        canvas = self.browser.find_element("id", "canvas")
        scale = self.ask("viewer.draw();"
                         "return viewer.scaleIn(canvas.clientWidth, canvas.clientHeight)")
        area = 4 * math.pi * RADIUS**2
        for x, text in ((-6, f"CA, ALA 7, chain A, {area:.1f} Å², convex"),
                        (6, f"OXT, GLY 9A, chain B, {area:.1f} Å², convex"), (0, "")):
            ActionChains(self.browser).move_to_element_with_offset(
                canvas, round(scale * x), 0).pause(0.2).perform()
            self.wait_for("return document.getElementById('tip').textContent", text)
        self.ask("viewer.set('style', 'spheres'); viewer.set('opacity', 0); viewer.draw()")
        self.assertEqual(self.ask("return viewer.textAt(canvas.clientWidth / 2 + "
                                  f"{6 * scale}, canvas.clientHeight / 2)"),
                         f"OXT, GLY 9A, chain B, {area:.1f} Å²")

    def wait_for(self, script, expected):
        from selenium.webdriver.support.wait import WebDriverWait
        WebDriverWait(self.browser, 60).until(
            lambda browser: browser.execute_script(script) == expected,
            f"expected {expected!r}")

    def test_controls_change_the_picture(self):
        """Clicks and keys, as a user makes them."""
        from selenium.webdriver import ActionChains, Keys
        from selenium.webdriver.support.select import Select
        self.open(self.atoms, self.atoms)
        Select(self.browser.find_element("id", "color")).select_by_visible_text("element")
        legend = self.browser.find_element("id", "legend").text.split()
        self.assertEqual(legend, ["C", "O"])
        Select(self.browser.find_element("id", "style")).select_by_value("balls")
        self.assertEqual(self.ask("return [viewer.look.style, viewer.look.opacity]"), ["balls", 45])
        canvas = self.browser.find_element("id", "canvas")
        before = self.ask("return viewer.view")
        ActionChains(self.browser).click_and_hold(canvas).move_by_offset(40, 0).release().perform()
        turned = self.ask("return viewer.view")
        self.assertNotEqual(before["rotation"], turned["rotation"])
        canvas.send_keys("+", Keys.SHIFT + Keys.ARROW_RIGHT)
        moved = self.ask("return viewer.view")
        self.assertGreater(moved["zoom"], before["zoom"])
        self.assertGreater(moved["pan"][0], 0)
        self.browser.find_element("id", "reset").click()
        self.assertEqual(self.ask("return [viewer.view.zoom, ...viewer.view.pan]"), [1, 0, 0])
        self.browser.find_element("css selector", "#parts summary").click()
        self.browser.find_element("css selector", "#parts input[type=checkbox]").click()  # chain A
        self.ask("viewer.lookAlong(2)")
        self.assertEqual(self.ask("return viewer.textAt(canvas.clientWidth / 4 - 6 * viewer.scaleIn("
                                  "canvas.clientWidth, canvas.clientHeight), canvas.clientHeight / 2)"),
                         "")
        self.browser.find_element("id", "help").click()
        self.assertTrue(self.browser.find_element("css selector", "#keys table").is_displayed())
        self.browser.find_element("css selector", "#keys button").click()
        names = [name.text.split("\n")[0] for name in
                 self.browser.find_elements("css selector", "#titles > div")]
        self.assertEqual(names, ["two.pqr"] * 2)
        self.assertEqual(browser_errors(self.browser), [])

    def test_saved_pictures_have_scale_and_legend(self):
        self.open(self.atoms, "--color", "patch")
        width, height, dark, blue = self.ask("""
          const picture = viewer.picture(), pen = picture.getContext("2d");
          const { data } = pen.getImageData(0, 0, picture.width, picture.height);
          let dark = 0, blue = 0;
          for (let i = 0; i < data.length; i += 4) {
            if (data[i] + data[i + 1] + data[i + 2] < 120) dark++;
            if (data[i] === 86 && data[i + 1] === 180 && data[i + 2] === 233) blue++;
          }
          return [picture.width, picture.height, dark, blue]""")
        self.assertGreaterEqual(width, 2000)
        self.assertGreater(height, 500)
        self.assertGreater(dark, 500)  # scale bar and text
        self.assertGreater(blue, 500)  # the square of the legend

    def test_legends_of_saved_pictures_are_beside_the_molecule(self):
        """The picture without its legend is the left part of the whole one."""
        self.open(self.atoms, "--color", "patch")
        bare, widths, squares, are_equal = self.ask("""
          const bytes = (picture, width) =>
            picture.getContext("2d").getImageData(0, 0, width, picture.height).data;
          const many = Array.from({ length: 99 }, (_, i) => [`chain ${i}`, [1, 2, 3 + i]]);
          const gradient = { stops: [[0, 0, 0], [255, 255, 255]], ticks: ["-1", "0", "1"], title: "t" };
          const legends = [viewer.legend(), { entries: [], gradient }, { entries: many, gradient }];
          const pictures = legends.map((legend) => {
            viewer.legend = () => legend;
            return viewer.picture();
          });
          viewer.legend = () => ({ entries: [] });
          const bare = viewer.picture(), left = bytes(bare, bare.width);
          const squares = new Set(), all = bytes(pictures[2], pictures[2].width);
          for (let i = 0; i < all.length; i += 4)
            if (all[i] === 1 && all[i + 1] === 2) squares.add(all[i + 2]);
          return [bare.width, pictures.map(({ width }) => width), squares.size, pictures.map((picture) =>
            bytes(picture, bare.width).every((byte, i) => byte === left[i]))]""")
        self.assertEqual(are_equal, [True] * 3)
        self.assertEqual(squares, 99)
        self.assertLess(bare, min(widths))
        self.assertGreater(widths[2] - bare, 2 * (widths[0] - bare))  # several columns

    def test_names_and_wide_legends_are_beside_the_molecule(self):
        for width, height in ((420, 800), (1000, 700)):
            self.browser.set_window_size(width, height)
            self.open(self.atoms, "--color", "area")
            self.ask("$('panel').open = false; viewer.lookAlong(1)")  # the atoms are above each other
            top, bottom = self.bytes_of_picture("""
              const rows = [];
              for (let i = 0; i < bytes.length; i += 4)
                if (Math.min(...bytes.subarray(i, i + 3)) < 230) rows.push(height - 1 - Math.floor(i / 4 / width));
              return [rows.at(-1), rows[0]].map((row) => row * canvas.clientHeight / height + canvas.getBoundingClientRect().top)""")
            name, legend = self.ask("return ['#titles div', '#legend'].map((name) => {"
                                    "const { top, bottom, left } = document.querySelector(name).getBoundingClientRect();"
                                    "return { top, bottom, left }})")
            self.assertGreaterEqual(top, name["bottom"] - 4)  # below its text
            if legend["left"] < 0.6 * width:
                self.assertLessEqual(bottom, legend["top"])
        self.browser.set_window_size(420, 800)
        self.open(self.atoms, self.atoms, "--color", "area")
        top, = self.ask("const [, panel] = viewer.panels(canvas.clientWidth, canvas.clientHeight);"
                        "return [panel.middle[1] - viewer.scaleIn(canvas.clientWidth, canvas.clientHeight) * viewer.half[1]]")
        self.assertGreater(top, self.ask("const name = document.querySelectorAll('#titles div')[1];"
                                         "return name.offsetTop + name.offsetHeight - 4"))

    def test_columns_of_tables_are_colours(self):
        """Negative and positive values of two residues, of which the second is named by its chain."""
        table = self.folder / "t.csv"
        table.write_text('"chain",residue_number,atoms,"gain, kT"\r\nA,7,1,-3\r\nB,9A,1,3\r\n')
        self.open(self.atoms, "--table", table)
        self.assertEqual(self.ask("return viewer.look.color"), "table:gain, kT")
        found = self.pixels()
        self.assertGreater(found["red"], 500)
        self.assertGreater(found["blue"], 500)
        self.assertIn("gain, kT", self.browser.find_element("id", "legend").text)
        self.ask("addTable(viewer, 'b.csv', 'serial,is_polar,sas_lost\\n1,1,5.5')")
        self.assertEqual(self.ask("return viewer.look.color"), "table:sas_lost")
        self.assertEqual(self.ask("return addTable(viewer, 'a.csv', 'x,y\\n1,2')"),
                         "a.csv has no column serial or residue_number")
        self.assertEqual(self.ask("return addTable(viewer, 'a.csv', 'serial,v\\n77,2')"),
                         "a.csv names no atom or residue of this page")

    def test_addresses_keep_the_view(self):
        from selenium.webdriver.support.wait import WebDriverWait
        self.open(self.atoms, "--color", "element")
        self.ask("viewer.set('clip', 30); viewer.turn(0.3, 0.2); viewer.zoom(2); viewer.move(9, 4);"
                 "viewer.show(viewer.molecules[0], [1], false)")
        before = self.ask("return viewer.address()")
        WebDriverWait(self.browser, 60).until(lambda browser: browser.current_url.endswith(before))
        self.browser.refresh()
        self.assertEqual(self.ask("return viewer.address()"), before)
        self.ask("viewer.restore('nonsense')")
        self.assertEqual(self.ask("return viewer.address()"), before)

    def test_cavities_are_seen_through_the_surface(self):
        """Eighteen atoms around a void: its volume is that of eses-blocks measure."""
        sphere = [(4.2, 0, 0), (3, 3, 0), (2.4, 2.4, 2.4)]
        places = {tuple(sign * value for sign, value in zip(signs, order))
                  for place in sphere for order in itertools.permutations(place)
                  for signs in itertools.product((1, -1), repeat=3)}
        atoms = self.folder / "shell.xyzr"
        atoms.write_text("".join(f"{x} {y} {z} 2\n" for x, y, z in sorted(places)))
        measured = json.loads(subprocess.run([PROGRAM, "measure", "--cavities", "--json", atoms],
                                             capture_output=True, text=True, check=True).stdout)
        (cavity,) = measured["cavities"]
        self.open(atoms)
        self.ask("viewer.set('cavities', true)")
        self.assertLess(self.ask("return viewer.look.opacity"), 100)
        label, = self.browser.find_elements("css selector", "#labels div")
        self.assertEqual(label.text, f"1: {cavity['void_volume']:.1f} Å³")
        found = self.pixels()
        self.assertGreater(found["red"] + found.get("orange", 0), 500)  # the wall, in its own colour

    def test_large_surfaces_turn_as_coarse_ones(self):
        """The coarse surface has the size of the other, and the same colours."""
        self.open(self.atoms, "--spacing", "0.03", "--color", "chain")
        whole = self.pixels()
        self.assertEqual(self.ask("return viewer.drawings[0].fast.count"), 0)  # only slow machines need it
        self.ask("viewer.isChanging = viewer.isSlow = true; viewer.ratio = 0.5; viewer.update = () => {}")
        fast = self.pixels()
        coarse, triangles = self.ask("return [viewer.drawings[0].fast.count, viewer.molecules[0].triangles]")
        self.assertGreater(coarse, 0)
        self.assertLess(coarse / 3, triangles / 2)
        for color in ("red", "blue"):  # half of the pixels in each direction
            self.assertAlmostEqual(4 * fast[color] / whole[color], 1, delta=0.1)
        self.assertLessEqual(self.ask("return viewer.ratio"), 0.5)

    def test_controls_have_labels_and_contrast(self):
        self.open(self.atoms)
        self.ask("viewer.set('theme', 'auto')")
        self.assertEqual(accessibility_faults(self.browser), [])
        self.browser.find_element("id", "help").click()
        self.assertEqual(accessibility_faults(self.browser), [])

    def test_small_screens_with_touch(self):
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": 390, "height": 700, "deviceScaleFactor": 1, "mobile": True})
        self.browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True})
        self.open(self.atoms, "--color", "patch")
        self.assertFalse(self.ask("return document.getElementById('panel').open"))
        self.assertLessEqual(self.ask("return document.documentElement.scrollWidth"), 390)
        self.assertGreater(self.pixels()["blue"], 500)

        def touch(kind, *points):
            self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {
                "type": kind, "touchPoints": [{"x": x, "y": y, "id": n}
                                              for n, (x, y) in enumerate(points)]})

        before = self.ask("return viewer.view")
        touch("touchStart", (150, 300), (240, 300))
        touch("touchMove", (105, 300), (285, 300))
        touch("touchEnd")
        after = self.ask("return viewer.view")
        # The fingers are twice as far apart, and their middle has not moved.
        self.assertAlmostEqual(after["zoom"] / before["zoom"], 2, delta=0.1)
        for a, b in zip(before["rotation"], after["rotation"]):
            self.assertAlmostEqual(a, b, delta=0.02)
        touch("touchStart", (200, 300))
        touch("touchMove", (200, 400))
        touch("touchEnd")
        self.assertNotEqual(self.ask("return viewer.view.rotation"), after["rotation"])
        self.ask("viewer.reset(); viewer.lookAlong(2); viewer.draw()")
        x = self.ask("return canvas.clientWidth / 2"
                     "- 6 * viewer.scaleIn(canvas.clientWidth, canvas.clientHeight)")
        y = self.ask("return canvas.getBoundingClientRect().top + canvas.clientHeight / 2")
        touch("touchStart", (x, y))
        touch("touchEnd")
        self.wait_for("return document.getElementById('tip').textContent.split(',')[0]", "CA")


if __name__ == "__main__":
    unittest.main()
