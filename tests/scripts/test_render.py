"""Tests that scripts/render draws a small mesh; skipped without VTK or a display."""

import os
import shutil
import struct
import subprocess
import unittest
import zlib

from support import DATA, PROGRAM, SCRIPTS, TestCase, can_import

SCRIPT = SCRIPTS / "render"


def can_draw():
    has_display = os.environ.get("DISPLAY") or shutil.which("xvfb-run")
    return bool(has_display) and can_import(SCRIPT, "vtk")


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

    def test_picture_shows_the_mesh(self):
        picture = self.make_picture("a.ply")
        width, height, rows = read_png(picture)
        self.assertEqual((width, height), (80, 60))
        # The picture is neither blank nor full: PNG's filters leave zeros where nothing changes.
        changes = sum(byte != 0 for byte in rows)
        self.assertGreater(changes, 500)
        self.assertLess(changes, len(rows))

    def test_wrong_files_are_refused(self):
        text = self.folder / "a.txt"
        text.write_text("none")
        for path, message in ((text, "not a .ply, .obj or .vtp file"),
                              (self.folder / "b.ply", "no such file")):
            done = self.render(path, "-o", self.folder / "c.png")
            self.assertEqual(done.returncode, 1)
            self.assertIn(message, done.stderr)
            self.assertFalse((self.folder / "c.png").exists())


if __name__ == "__main__":
    unittest.main()
