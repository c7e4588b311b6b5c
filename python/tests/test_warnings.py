"""Warnings about suspicious input, files that are not overwritten, and arguments that are refused by name."""

import copy
import os
import pickle
import warnings

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA

NANOMETRES = "atoms are within 0.45 angstrom of their nearest neighbours, .*coordinates look like nanometres"
PROTEIN = """\
ATOM      1  N   ALA A  10      11.104   6.134  -6.504  1.00  0.00           N
ATOM      2  CA  ALA A  10      11.639   6.071  -5.147  1.00  0.00           C
ATOM      3  C   ALA A  10      10.594   5.544  -4.167  1.00  0.00           C
ATOM      4  O   ALA A  10       9.393   5.761  -4.333  1.00  0.00           O
ATOM      5  N   SER B   1      11.068   4.851  -3.135  1.00  0.00           N
ATOM      6  CA  SER B   1      10.189   4.299  -2.111  1.00  0.00           C
"""
COARSE = """\
ATOM      1  BB  ALA A   1       0.000   0.000   0.000  1.00  0.00
ATOM      2  BB  LYS A   2       3.500   0.000   0.000  1.00  0.00
ATOM      3  SC1 LYS A   2       5.500   2.000   0.000  1.00  0.00
"""


@pytest.fixture(name="protein")
def fixture_protein(needs_gemmi, tmp_path):
    path = tmp_path / "p.pdb"
    path.write_text(PROTEIN)
    return path


def measure_opened(path):
    with open(path, "rb") as opened:
        return eses.measure(opened)


# ---------------------------------------------------------------------------------- warnings


@pytest.mark.usefixtures("needs_gemmi")
def test_coarse_grained_residues_are_one_warning(tmp_path):
    path = tmp_path / "cg.pdb"
    path.write_text(COARSE)
    text = r"cg.pdb: 2 residues are no amino acids, nucleotides or water .* guesses: lines 1, 2$"
    for call in (eses.read_atoms, eses.measure, eses.read_molecule, measure_opened,
                 lambda path: eses.measure(path, report="//A/2")):
        with pytest.warns(UserWarning, match=text) as caught:
            call(path)
        assert len(caught) == 1
    with pytest.warns(UserWarning, match="^text: 2 residues"):
        eses.measure(COARSE)


def test_lines_that_are_not_read_are_a_warning(tmp_path):
    path = tmp_path / "a.pqr"
    path.write_text("ATAM 1 N ALA 1 0 0 0 0.1 1.5\nATOM 2 CA ALA 1 1.5 0 0 0.1 1.7\n")
    with pytest.warns(UserWarning, match="a.pqr: 1 line has coordinates.*: line 1$"):
        eses.read_atoms(path)


def test_suspicious_atoms_are_a_warning():
    centers, radii = [[0, 0, 0], [5, 0, 0], [5, 0, 0], [9, 0, 0]], [1.5, 1.5, 1.5, 5]
    with pytest.warns(UserWarning) as caught:
        surface = eses.Surface(centers, radii)
    assert [str(warning.message) for warning in caught] == [
        "1 atom has the centre and radius of an earlier one: index 2", "1 atom has a radius above 4 angstrom: index 3"]
    assert str(surface.diagnostics[1]) == "1 atom has a radius above 4 angstrom"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pickle.loads(pickle.dumps(surface))
        eses.Surface([[0, 0, 0], [1, 0, 0]], [1.5, 0])  # a hydrogen without radius is usual


def test_nanometres_in_frames_are_one_warning(chain):
    centers, radii = chain
    frames = np.stack([centers / 20, centers / 20 + 0.01, centers / 20 + 0.02])
    for given in (frames, list(frames), iter(frames), frames.astype(np.float32)):
        with pytest.warns(UserWarning, match="^frame 0: .*" + NANOMETRES) as caught:
            eses.measure_frames(given, radii)
        assert len(caught) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        eses.measure_frames(20 * frames, radii)


def test_stray_atoms_are_named_by_measures():
    near, radii = [[float(i), 0, 0] for i in range(9)], np.full(10, 1.7)
    strays = np.array([[9999.0, 9999, 9999], *near])
    with pytest.warns(UserWarning, match="^1 atom is far from all others: index 0$"):
        eses.measure(strays, radii)
    with pytest.warns(UserWarning, match="^1 atom is far from all others: index 9$"):  # of all atoms, not of the selected ones
        eses.measure(np.array([*near[:4], *near[:1], *near[5:], [9999, 9999, 9999]]), radii, select=np.arange(10) != 4)
    with pytest.warns(UserWarning, match="^1 atom is far from all others: index 0$"):
        eses.interface((strays, radii), np.arange(10) < 5, np.arange(10) >= 5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        eses.measure(near, radii[1:])
        eses.measure(np.concatenate([near, np.array(near) + 9999]), np.full(18, 1.7))  # two copies of a molecule


def test_far_atoms_are_named_and_refused():
    far = [[float(i), 0, 0] for i in range(9)]
    radii = np.full(10, 1.7)
    surface = eses.Surface([*far, [2000, 2000, 2000]], radii)
    for call in (surface.grid, surface.pockets, surface.show):
        with pytest.raises(ValueError, match="1 atom is far from the others .* index 9; leave out .* allow_far_atoms"):
            call()
    assert surface.grid(allow_far_atoms=True).size > 1e10
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for value in (np.inf, -np.inf, np.nan, 0, 1e308):  # refused without a warning about the atoms
            with pytest.raises(ValueError, match="spacing"):
                surface.pockets(spacing=value)
            with pytest.raises(ValueError, match="spacing"):
                surface.grid(value)
        with pytest.raises(ValueError, match="margin"):
            surface.grid(0.5, margin=np.inf)
    assert surface.grid(shape=(9, 9, 9), origin=(0, 0, 0)).size == 729
    with pytest.warns(UserWarning, match="1 atom is far from the others and stretches the grid.* index 9$"):
        eses.Surface([*far, [200, 200, 200]], radii).grid()


# ------------------------------------------------------------------- nothing that is read is written


def test_files_that_were_read_are_not_overwritten(protein, tmp_path):
    names = [protein, tmp_path / "link.pdb", tmp_path / "hard.pdb", os.fsencode(protein), str(protein)]
    os.symlink(protein, names[1])
    os.link(protein, names[2])
    surface, atoms = eses.Surface(protein), eses.read_atoms(protein)
    measured = [eses.measure(protein), measure_opened(protein), eses.measure(atoms),
                *map(eses.measure, (surface, copy.copy(surface), copy.deepcopy(surface), pickle.loads(pickle.dumps(surface)),
                                    eses.Surface(surface), eses.Surface(atoms), copy.deepcopy(atoms),
                                    pickle.loads(pickle.dumps(atoms)), eses.measure(protein).surface)),
                pickle.loads(pickle.dumps(eses.measure(protein))), eses.interface(protein, "A", "B")]
    for name in names:
        for result in (*measured, measured[0].atoms, measured[0].residues, measured[0].chains,
                       pickle.loads(pickle.dumps(measured[0].atoms)), measured[-1].atoms, measured[-1].residues,
                       eses.interfaces(protein).table):
            with pytest.raises(ValueError, match="was read, and would be overwritten; choose another name"):
                result.save(name)
    assert protein.read_text() == PROTEIN
    measured[0].save(tmp_path / "new.pdb")
    measured[0].save(tmp_path / "new.pdb")
    eses.measure(PROTEIN).save(protein)  # a text is no file
    assert protein.read_text() != PROTEIN


def test_the_file_of_radii_is_not_overwritten(protein, tmp_path):
    radii = tmp_path / "radii.csv"
    radii.write_text("name: x\ntypes:\nALL 1.5 polar\natoms:\n" + "".join(
        f"ANY {name} ALL\n" for name in ("N", "CA", "C", "O")))
    with pytest.raises(ValueError, match="radii.csv was read"):
        eses.measure(protein, radii).save(radii)


def test_pages_are_not_written_over_other_files(tmp_path):
    page = eses.Surface([[0, 0, 0]], [1.5]).show()
    for name in ("a.pdb", "a.PDB", "a.cif.gz", "a.png", b"a.csv"):
        with pytest.raises(ValueError, match="would be a page; use a name that ends in .html"):
            page.save(name)
    page.save(os.fsencode(tmp_path / "a.html"))
    assert (tmp_path / "a.html").read_text(encoding="utf-8").startswith("<!")


# ----------------------------------------------------------------------------------- arguments


def test_paths_are_bytes_or_a_type_error(protein, tmp_path):
    result = eses.measure(protein)
    for name in ("b.pdb", "b.cif", "b.csv"):
        result.save(os.fsencode(tmp_path / name))
        assert (tmp_path / name).stat().st_size > 0
    with open(tmp_path / "c.csv", "w", encoding="ascii") as opened:
        for save in (result.save, result.atoms.save, eses.Surface([[0, 0, 0]], [1.5]).show().save):
            with pytest.raises(TypeError, match="TextIOWrapper"):
                save(opened)
    with open(DATA / "c60.xyzr", encoding="ascii") as opened:
        with pytest.raises(TypeError, match="path must be a str, bytes, os.PathLike, not TextIOWrapper"):
            eses.read_grid(opened)


@pytest.mark.parametrize("value, expected", [
    (np.array(True), True), (np.array(False), False), (np.bool_(True), True), (np.array(5.5), 5.5),
    (np.float32(2), 2), (np.int64(3), 3), (np.array(3), 3)])
def test_scalars_of_numpy_fill_cavities(value, expected):
    found = eses.Surface([[0, 0, 0]], [1.5], fill_cavities=value).fill_cavities
    assert found == expected and isinstance(found, bool) == isinstance(expected, bool)


@pytest.mark.parametrize("value", [np.array([True]), np.array([1.0]), [True], "1", np.array("x"), None, object()])
def test_other_objects_do_not_fill_cavities(value):
    with pytest.raises(TypeError, match="fill_cavities must be a boolean or a volume in cubic angstrom"):
        eses.Surface([[0, 0, 0]], [1.5], fill_cavities=value)
    with pytest.raises(TypeError, match="fill_cavities must be a boolean or a volume in cubic angstrom"):
        eses.measure_frames([[[0, 0, 0]]], [1.5], fill_cavities=value)


def test_atoms_of_another_order_are_noticed(protein):
    pytest.importorskip("pandas")
    atoms = eses.read_atoms(protein)
    surface = eses.Surface(atoms.centers[::-1], atoms.radii[::-1])
    result = surface.compute(surface.grid(0.8))
    for call in (result.residue_table, result.atom_table, lambda atoms: surface.show(0.8, atoms)):
        with pytest.raises(ValueError, match="the atoms are those of the surface in another order"):
            call(atoms)
        with pytest.raises(ValueError, match="the surface has 6 atoms, but 12 are given"):
            call(twice(protein))


def twice(path):
    """Returns the atoms of two copies of a structure."""
    other = path.with_name("twice.pdb")
    moved = "".join(f"{line[:30]}{float(line[30:38]) + 30:8.3f}{line[38:]}\n" for line in PROTEIN.splitlines())
    other.write_text(PROTEIN + moved.replace(" A  10", " C  10").replace(" B   1", " D   1"))
    return eses.read_atoms(other)


@pytest.mark.parametrize("height", ["x", None, True, [1]])
def test_the_height_of_a_page_is_a_number(height):
    with pytest.raises(TypeError, match="height must be a number"):
        eses.Surface([[0, 0, 0]], [1.5]).show(height=height)


@pytest.mark.parametrize("kind", [list, tuple])
def test_lists_of_one_buffer_are_refused(kind, chain):
    centers, radii = chain
    buffer = np.array(centers)

    def read():
        for k in range(3):
            buffer[:] = np.array(centers) + k
            yield buffer

    for frames in (read(), (frame[:] for frame in read()), (frame.view() for frame in read())):
        with pytest.raises(ValueError, match="frames 0 and 1 share their memory and are equal.* copy each frame"):
            eses.measure_frames(kind(frames), radii)
    assert len(eses.measure_frames(kind(frame.copy() for frame in read()), radii).sas_area) == 3
    whole = np.stack([np.array(centers) + k for k in range(3)], axis=2)
    assert len(eses.measure_frames(kind(whole[:, :, k] for k in range(3)), radii).sas_area) == 3
