"""Tests of scripts/dev/make-diagrams: the diagrams in doc/, and their geometry."""

import math
import re
import subprocess
import sys
import unittest
import xml.etree.ElementTree

from support import PROJECT, SCRIPTS, TestCase

from diagrams import Diagram, DiscSurface, Panel, on_circle

DOC = PROJECT / "doc"
SVG = "{http://www.w3.org/2000/svg}"


class MakeDiagrams(TestCase):
    def setUp(self):
        super().setUp()
        done = subprocess.run(
            [sys.executable, SCRIPTS / "dev" / "make-diagrams", "-o", self.folder],
            stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        self.assertDone(done)
        self.assertEqual(done.stderr, "")

    def test_diagrams_in_doc_are_those_of_the_script(self):
        names = sorted(path.name for path in self.folder.iterdir())
        self.assertEqual(names, sorted(path.name for path in DOC.glob("algorithm-*.svg")))
        for name in names:
            with self.subTest(name=name):
                self.assertEqual((self.folder / name).read_text(encoding="utf-8"),
                                 (DOC / name).read_text(encoding="utf-8"))

    def test_diagrams_are_wellformed_xml(self):
        for path in self.folder.iterdir():
            with self.subTest(name=path.name):
                root = xml.etree.ElementTree.parse(path).getroot()
                self.assertEqual(root.tag, f"{SVG}svg")
                self.assertLessEqual(int(root.get("width")), 700)
                self.assertTrue(root.find(f"{SVG}title").text)
                self.assertGreater(len(root.findall(f"{SVG}path")), 4)

    def test_page_shows_each_diagram(self):
        page = (DOC / "algorithm.md").read_text(encoding="utf-8")
        shown = re.findall(r"!\[[^]]+\]\((algorithm-[a-z]+\.svg)\)", page)
        self.assertEqual(sorted(shown), sorted(path.name for path in self.folder.iterdir()))


class Labels(unittest.TestCase):
    def test_mathematics_is_set_in_italics_and_subscripts(self):
        diagram = Diagram(200, 100, "a formula")
        diagram.label(50, 50, "radius $r_i$")
        text = xml.etree.ElementTree.fromstring(diagram.text()).find(f"{SVG}text")
        parts = [(part.text, part.get("font-style"), part.get("dy")) for part in text]
        self.assertEqual(parts, [("radius", None, None), ("r", "italic", None),
                                 ("i", "italic", "4")])


class Surface(unittest.TestCase):
    def test_one_disc_is_exposed_all_around(self):
        faces = DiscSurface([(1, 2, 3)], 1).faces
        self.assertEqual([(face.start, face.end) for face in faces], [(0, 2 * math.pi)])

    def test_two_discs_have_the_arcs_computed_by_hand(self):
        # SAS circles of radius 5 about (-3, 0) and (3, 0) meet at (0, 4) and (0, -4).
        surface = DiscSurface([(-3, 0, 4), (3, 0, 4)], 1)
        self.assertEqual(len(surface.faces), 2)
        vertices = sorted(surface.vertex_behind(face) for face in surface.faces)
        for vertex, expected in zip(sorted(vertices, key=lambda point: point[1]),
                                    ((0, -4), (0, 4))):
            self.assertLess(math.dist(vertex, expected), 1e-12)
        for face in surface.loop(surface.faces[0]):
            # The re-entrant arc begins and ends where the probe touches the discs.
            vertex = surface.vertex_behind(face)
            discs = (face.disc, surface.next_face(face).disc)
            for angle, disc in zip(surface.contact_angles(face), discs):
                self.assertAlmostEqual(math.dist(on_circle(vertex, 1, angle), disc[:2]), 4)

    def test_a_buried_disc_has_no_face(self):
        around = [(*on_circle((0, 0), 3, turn * math.pi / 3), 2) for turn in range(6)]
        surface = DiscSurface([*around, (0, 0, 1)], 1.4)
        self.assertEqual(len(surface.loop(surface.faces[0])), 6)
        self.assertNotIn((0, 0, 1), [face.disc for face in surface.faces])

    def test_arcs_have_the_right_direction_on_the_page(self):
        """Upwards in the scene is upwards on the page."""
        panel = Panel(Diagram(100, 100, "an arc"), (50, 50), 10)
        panel.arc((0, 0), 2, 0, math.pi / 2)
        points = re.search('d="M([^"]*)"', panel.diagram.elements[0])[1].split("L")
        self.assertEqual((points[0], points[-1]), ("70 50", "50 30"))
        self.assertGreater(len(points), 20)


if __name__ == "__main__":
    unittest.main()
