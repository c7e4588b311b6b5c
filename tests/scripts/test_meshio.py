"""Tests that meshio reads meshes; skipped without it (pip install meshio)."""

import subprocess
import unittest

from support import DATA, PROGRAM, TestCase

try:
    import meshio
except ImportError:
    meshio = None


@unittest.skipUnless(meshio, "meshio is not installed")
class ReadByMeshio(TestCase):
    def test_every_format_has_the_same_mesh(self):
        meshes = []
        for name, *more in (("a.off",), ("a.obj",), ("a.ply",), ("b.ply", "--ply-ascii")):
            path = self.folder / name
            self.assertDone(subprocess.run(
                [PROGRAM, DATA / "c60.xyzr", "-q", "--write", "none", "--mesh", path, *more],
                capture_output=True, text=True, check=False))
            meshes.append(meshio.read(path))
        for mesh in meshes:
            triangles = mesh.cells_dict["triangle"]
            self.assertGreater(len(triangles), 0)
            self.assertTrue((triangles == meshes[0].cells_dict["triangle"]).all())
            self.assertLess(abs(mesh.points - meshes[0].points).max(), 1e-6)


if __name__ == "__main__":
    unittest.main()
