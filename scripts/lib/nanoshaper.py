"""Runs NanoShaper, for the scripts that compare with it."""

import pathlib

from eses_tools.atoms import read_atoms
from eses_tools.common import Failed
from eses_tools import measuring

# Cavities are not filled, and no maps are made. Grid_scale is the number of points per angstrom.
SETTINGS = """\
XYZR_FileName = atoms.xyzr
Surface = ses
Probe_Radius = {probe_radius}
Grid_scale = {grid_scale}
Grid_perfil = 90
Triangulation = true
Accurate_Triangulation = true
Smooth_Mesh = false
Build_epsilon_maps = false
Build_status_map = false
Cavity_Detection_Filling = false
Number_thread = 1
"""


def make_mesh(program, reader, atoms, probe_radius, spacing, directory):
    """Makes a mesh with one thread. Returns its path in `directory`, and the resource usage. `reader` is the path of
    eses-blocks, which reads the atoms.

    Throws Failed if there is no mesh.
    """
    (directory / "atoms.xyzr").write_text(
        "".join(f"{atom.x} {atom.y} {atom.z} {atom.radius}\n" for atom in read_atoms(atoms, program=reader)
                if float(atom.radius) > 0), encoding="ascii")
    (directory / "surface.prm").write_text(
        SETTINGS.format(probe_radius=probe_radius, grid_scale=1 / spacing), encoding="ascii")
    log, mesh = directory / "log", directory / "triangulatedSurf.off"
    with open(log, "w", encoding="utf-8") as messages:
        code, _, usage = measuring.run([pathlib.Path(program).absolute(), "surface.prm"], messages,
                                       messages, cwd=directory)
    if code != 0 or not mesh.is_file():
        lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
        raise Failed(f"NanoShaper: exit code {code}: {lines[-1] if lines else 'no mesh'}")
    return mesh, usage
