"""Tests that scripts/render draws a small mesh; skipped without VTK or a display."""

import colorsys
import importlib.util
import math
import os
import signal
import struct
import subprocess
import unittest
import unittest.mock
import zlib

from support import DATA, PROGRAM, SCRIPTS, TestCase, can_draw, interpreter_of, write_map

from eses_tools import common, render  # after support, which makes the modules of the scripts known

SCRIPT = SCRIPTS / "render"


def read_png(path):
    """Returns width, height and rows of an 8-bit RGB picture without interlacing."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", data[at + 8:at + 18])
        elif kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    assert (depth, color) == (8, 2)
    return width, height, zlib.decompress(packed)


def pixels(path):
    """Returns the rows of a picture as lists of (red, green, blue), without PNG's filters."""
    width, height, packed = read_png(path)
    rows, above = [], bytes(3 * width)
    for number in range(height):
        kind, *line = packed[number * (3 * width + 1):(number + 1) * (3 * width + 1)]
        for at in range(3 * width):
            left, up = line[at - 3] if at > 2 else 0, above[at]
            corner = above[at - 3] if at > 2 else 0
            guess = left + up - corner
            paeth = min((left, up, corner), key=lambda value: abs(guess - value))
            line[at] = (line[at] + (0, left, up, (left + up) // 2, paeth)[kind]) % 256
        rows.append([tuple(line[at:at + 3]) for at in range(0, 3 * width, 3)])
        above = line
    return rows


WHITE = (255, 255, 255)
PALETTE = {"convex": (86, 180, 233), "saddle": (240, 228, 66), "concave": (213, 94, 0)}


def frame(rows):
    """Returns the first and last column and row that are not white."""
    lines = [y for y, row in enumerate(rows) if set(row) != {WHITE}]
    columns = [x for x in range(len(rows[0])) if any(row[x] != WHITE for row in rows)]
    return columns[0], columns[-1], lines[0], lines[-1]


def hue(color):
    return colorsys.rgb_to_hsv(*color)[0]


@unittest.skipUnless(can_draw(), "needs python3-vtk9, and a display or xvfb")
class Render(TestCase):
    def render(self, *arguments):
        return subprocess.run([SCRIPT, *map(str, arguments)], capture_output=True, text=True,
                              check=False, timeout=120)

    def make_picture(self, name, *options):
        mesh, picture = self.folder / name, self.folder / f"{name}.png"
        self.assertDone(subprocess.run(
            [PROGRAM, DATA / "c60.xyzr", "-q", "--write", "none", "--mesh", mesh, *options],
            capture_output=True, text=True, check=False))
        self.assertDone(self.render(mesh, "-o", picture, "--size", 80))
        return picture

    def test_ply_and_vtp_give_the_same_picture(self):
        for options in ((), ("--color", "atom")):
            ply = read_png(self.make_picture("a.ply", *options))
            vtp = read_png(self.make_picture("a.vtp", *options))
            self.assertEqual(vtp[:2], ply[:2])
            self.assertLess(self.differences(vtp[2], ply[2]), 50)
        plain = read_png(self.make_picture("b.vtp"))
        self.assertGreater(self.differences(plain[2], ply[2]), 500)

    @staticmethod
    def differences(rows, others):
        """Returns the number of bytes, differences by PNG's filters, that differ by more than rounding."""
        return sum((a - b + 4) % 256 > 8 for a, b in zip(rows, others))

    def test_pictures_need_no_server_where_vtk_has_egl(self):
        mesh = self.folder / "a.ply"
        self.assertDone(subprocess.run([PROGRAM, DATA / "c60.xyzr", "-q", "--write", "none", "--mesh", mesh],
                                       capture_output=True, text=True, check=False))
        picture = self.folder / "a.png"
        # No program is found in this path, so that there is no Xvfb.
        done = subprocess.run([interpreter_of(SCRIPT).split()[0], SCRIPT, mesh, "-o", picture, "--size", "80"],
                              env={"PATH": str(self.folder), "HOME": str(self.folder)}, capture_output=True, text=True,
                              check=False)
        if "install xvfb" in done.stderr:
            self.assertEqual(done.stderr, "render: there is no display; install xvfb, or VTK from PyPI (pip install vtk)\n")
            self.skipTest("this VTK needs a display")
        self.assertDone(done)
        self.assertEqual(read_png(picture)[:2], (80, 60))

    def test_picture_shows_the_mesh(self):
        picture = self.make_picture("a.ply")
        width, height, rows = read_png(picture)
        self.assertEqual((width, height), (80, 60))
        # The picture is neither blank nor full: PNG's filters leave zeros where nothing changes.
        changes = sum(byte != 0 for byte in rows)
        self.assertGreater(changes, 500)
        self.assertLess(changes, len(rows))

    def picture_of(self, atoms, *options, more=("--no-legend",)):
        source, mesh = self.folder / "atoms.xyzr", self.folder / "m.ply"
        source.write_text("".join(f"{x} {y} {z} {r}\n" for x, y, z, r in atoms))
        self.assertDone(subprocess.run([PROGRAM, source, "-q", "--write", "none", "--mesh", mesh,
                                        *options], capture_output=True, text=True, check=False))
        self.assertDone(self.render(mesh, "-o", self.folder / "m.png", "--size", 160, *more))
        return pixels(self.folder / "m.png")

    def test_meshes_of_all_shapes_fit(self):
        """The longer side fills the picture up to its margin."""
        for shape in ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)):
            with self.subTest(shape=shape):
                rows = self.picture_of([(*(3 * n * part for part in shape), 1.5) for n in range(8)])
                width, height = len(rows[0]), len(rows)
                left, right, top, bottom = frame(rows)
                for free, length in ((left, width), (width - 1 - right, width), (top, height),
                                     (height - 1 - bottom, height)):
                    self.assertGreater(free, 0.015 * length)
                self.assertGreater(max((right - left) / width, (bottom - top) / height), 0.9)

    def test_borders_of_patches_are_sharp(self):
        """Colours between those of two patches are rare: only at pixels that show both."""
        rows = self.picture_of([(0, 0, 0, 1.7), (3, 0, 0, 1.7), (1.5, 0, 2.6, 1.7)], "--color", "patch",
                               "--spacing", "0.7")
        shown = [color for row in rows for color in row if max(color) - min(color) > 60]
        self.assertGreater(len(shown), 3000)
        known = [hue(color) for color in PALETTE.values()]
        blended = sum(min(abs(hue(color) - one) for one in known) > 0.04 for color in shown)
        self.assertLess(blended, 0.06 * len(shown))

    def test_legend_names_the_kinds_of_patches(self):
        atoms = [(0, 0, 0, 1.7), (3, 0, 0, 1.7), (1.5, 0, 2.6, 1.7)]
        for color, expected in (("patch", set(PALETTE.values())), ("atom", set())):
            rows = self.picture_of(atoms, "--color", color, more=())
            beside = {pixel for row in rows for pixel in row[-22:]} - {WHITE}
            self.assertEqual(expected & beside, expected)
            self.assertEqual(bool(beside), bool(expected))
        rows = self.picture_of(atoms, "--color", "patch")
        self.assertEqual({pixel for row in rows for pixel in row[-4:]}, {WHITE})

    def test_legend_names_the_chains(self):
        for names, count in (("AB", 2), ("AA", 1), ("A", 1)):
            with self.subTest(names=names):
                lines = (f"ATOM {n} C ALA {name} 1 {3 * n} 0 0 0 1.7\n" for n, name in enumerate(names))
                source = self.folder / "chains.pqr"
                source.write_text("".join(lines))
                for mesh in ("c.ply", "c.vtp"):
                    self.assertDone(subprocess.run(
                        [PROGRAM, source, "-q", "--write", "none", "--color", "chain", "--mesh",
                         self.folder / mesh], capture_output=True, text=True, check=False))
                    picture = self.folder / "c.png"
                    self.assertDone(self.render(self.folder / mesh, "-o", picture, "--size", 160))
                    # Squares have pure colours, and the names are grey.
                    beside = {pixel for row in pixels(picture) for pixel in row[-22:]
                              if max(pixel) - min(pixel) > 100}
                    self.assertEqual(len(beside), count)

    def test_potential_is_red_where_negative_and_blue_where_positive(self):
        field = write_map(self.folder / "x.dx", 5)
        rows = self.picture_of([(-4, 0, 0, 1.7), (4, 0, 0, 1.7)],
                               more=("--azimuth", 0, "--potential", field))
        middle = rows[len(rows) // 2]
        shown = [color for color in middle[:-22] if max(color) - min(color) > 40]
        is_red = [red > blue for red, _, blue in shown]
        self.assertEqual(is_red, sorted(is_red, reverse=True))
        self.assertGreater(is_red.count(True), 10)
        self.assertGreater(is_red.count(False), 10)
        legend = {pixel for row in rows for pixel in row[-22:]}
        self.assertLessEqual({(200, 20, 30), (25, 50, 205)}, legend)

    def test_cavities_are_shown_in_a_section(self):
        """A hollow cube of atoms, whose middle line crosses wall, cavity and wall."""
        places = [(x, y, z) for x in range(5) for y in range(5) for z in range(5)
                  if {0, 4} & {x, y, z}]
        for options in ((), ("--color", "patch")):
            with self.subTest(options=options):
                rows = self.picture_of(
                    [(2.5 * x, 2.5 * y, 2.5 * z, 1.8) for x, y, z in places], *options,
                    more=("--azimuth", 0, "--elevation", 0, "--cavities", "--flat"))
                middle = [color for color in rows[len(rows) // 2][:-22] if color != WHITE]
                parts = ["cavity" if red > blue + 80 else "section" for red, _, blue in middle]
                cavity = [at for at, part in enumerate(parts) if part == "cavity"]
                # The cube has the side 4 * 2.5 + 2 * 1.8 = 13.6. The cavity reaches to atoms at 0
                # and 10.
                self.assertEqual(cavity, list(range(cavity[0], cavity[-1] + 1)))
                self.assertAlmostEqual(len(cavity) / len(parts), (10 - 2 * 1.8) / 13.6, delta=0.06)
                self.assertAlmostEqual(cavity[0], len(parts) - 1 - cavity[-1], delta=2)

    def test_meshes_without_cavities_are_not_cut(self):
        mesh = self.folder / "a.ply"
        (self.folder / "a.xyzr").write_text("0 0 0 1.7\n")
        self.assertDone(subprocess.run([PROGRAM, self.folder / "a.xyzr", "-q", "--write", "none", "--mesh",
                                        mesh], capture_output=True, text=True, check=False))
        done = self.render(mesh, "--cavities", "-o", self.folder / "c.png")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no cavities", done.stderr)
        done = self.render(mesh, mesh, "--cavities", "-o", self.folder / "c.png")
        self.assertEqual(done.returncode, 2)

    def test_potentials_of_files_are_drawn(self):
        field, mesh = write_map(self.folder / "x.dx", 5), self.folder / "a.ply"
        (self.folder / "a.xyzr").write_text("-4 0 0 1.7\n4 0 0 1.7\n")
        self.assertDone(subprocess.run([PROGRAM, self.folder / "a.xyzr", "-q", "--write", "none", "--mesh",
                                        mesh, "--color", "potential", "--potential", field],
                                       capture_output=True, text=True, check=False))
        for more in ((), ("--potential", field)):
            self.assertDone(self.render(mesh, "-o", self.folder / f"{len(more)}.png", "--size", 100, *more))
        of_file, of_map = (sum(pixels(self.folder / f"{count}.png"), []) for count in (0, 2))
        self.assertEqual(len(of_file), len(of_map))
        # The potential has single precision in the file, and a pixel of an edge can differ.
        different = sum(max(abs(a - b) for a, b in zip(one, other)) > 2 for one, other in zip(of_file, of_map))
        self.assertLess(different, len(of_map) / 100)
        self.assertIn((200, 20, 30), of_file)  # the legend

    def test_wrong_files_are_refused(self):
        text = self.folder / "a.txt"
        text.write_text("none")
        infinite = self.folder / "a.off"
        infinite.write_text("OFF\n3 1 0\nnan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        for path, message in ((infinite, "a coordinate or normal is no finite number"),
                              (text, "not a .ply, .vtp, .obj, .off, .stl, .glb, .vert or .face file"),
                              (self.folder / "b.ply", "no such file")):
            done = self.render(path, "-o", self.folder / "c.png")
            self.assertEqual(done.returncode, 1)
            self.assertIn(message, done.stderr)
            self.assertFalse((self.folder / "c.png").exists())


@unittest.skipUnless(importlib.util.find_spec("numpy"), "numpy is not installed")
class Borders(TestCase):
    def test_borders_of_contact_circles_are_exact(self):
        """Two spheres: a place is on the saddle if the probe that touches the nearer sphere in its
        direction would overlap the other sphere."""
        from eses_tools import meshes
        import numpy
        from eses_tools import patch_borders
        radius, probe, half = 1.7, 1.4, 1.6
        source, mesh_file = self.folder / "two.xyzr", self.folder / "two.ply"
        source.write_text(f"{-half} 0 0 {radius}\n{half} 0 0 {radius}\n")
        for format_options in ((), ("--ply-ascii",)):
            self.assertDone(subprocess.run([PROGRAM, source, "-q", "--write", "none", "--mesh", mesh_file,
                                            "--color", "patch", "--spacing", "0.6", *format_options],
                                           capture_output=True, text=True, check=False))
            mesh = meshes.read_mesh(mesh_file)
            points, _, triangles, owners = patch_borders.divide_by_kind(mesh)
            colors = mesh.values["color"][owners]
            corners = points[triangles]
            middle = corners.mean(axis=1)
            away = numpy.abs(middle[:, 0]) - half
            toward = -away / numpy.hypot(away, numpy.hypot(middle[:, 1], middle[:, 2]))
            is_saddle = toward > half / (radius + probe)
            areas = numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0],
                                                  corners[:, 2] - corners[:, 0]), axis=1) / 2
            is_right = (colors == numpy.where(is_saddle[:, None], PALETTE["saddle"],
                                              PALETTE["convex"])).all(axis=1)
            self.assertGreater(areas[is_saddle].sum(), 0.1 * areas.sum())
            self.assertLess(areas[~is_right].sum(), 1e-3 * areas.sum())

    def test_spheres_have_creases(self):
        """On the solvent accessible surface of two spheres, triangles are cut in the plane where they meet, and each part
        has the normals of its sphere."""
        from eses_tools import meshes, patch_borders
        import numpy
        source, mesh_file, radii, places = self.folder / "two.xyzr", self.folder / "two.ply", (1.2, 1.9), (-1.5, 1.5)
        source.write_text("".join(f"{x} 0 0 {radius}\n" for x, radius in zip(places, radii)))
        self.assertDone(subprocess.run([PROGRAM, source, "-q", "--write", "none", "--mesh", mesh_file, "--surface", "sas",
                                        "--color", "atom", "--spacing", "0.6"], capture_output=True, text=True, check=False))
        mesh = meshes.read_mesh(mesh_file)
        points, normals, triangles, owners = patch_borders.cut_by_atom(mesh)
        atoms = mesh.values["atom"][owners]
        self.assertTrue((atoms[triangles] == atoms[triangles][:, :1]).all())
        plane = (places[1]**2 - places[0]**2 + (radii[0] + 1.4)**2 - (radii[1] + 1.4)**2) / (2 * (places[1] - places[0]))
        beyond = numpy.where(atoms == 0, points[:, 0] - plane, plane - points[:, 0])
        self.assertLess(beyond.max(), 1e-3)
        self.assertGreater((numpy.abs(beyond) < 1e-3).sum(), 20)
        away = points - numpy.array([[x, 0, 0] for x in places])[atoms]
        self.assertLess(numpy.abs(numpy.cross(away, normals)).max(), 1e-2)
        def area(points, triangles):
            a, b, c = (points[triangles[:, corner]] for corner in range(3))
            return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum() / 2
        self.assertAlmostEqual(area(points, triangles), area(mesh.points.astype(float), mesh.triangles), delta=0.01)


class PicturesOfAnotherProcess(TestCase):
    def test_a_process_that_is_killed_while_it_sends_is_a_message(self):
        def send_a_part(_options, target, _log):
            os.write(target.fileno(), struct.pack("!i", 1000) + b"a part")
            os.kill(os.getpid(), signal.SIGKILL)

        with unittest.mock.patch.object(render, "send_picture", send_a_part):
            with self.assertRaisesRegex(common.Failed, "^no picture: VTK ended with SIGKILL on the display "):
                render.draw_apart(None)


if __name__ == "__main__":
    unittest.main()
