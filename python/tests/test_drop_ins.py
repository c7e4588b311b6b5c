"""Functions in place of those of other libraries, against the originals within their sampling errors."""

import inspect
import warnings

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA

pytestmark = pytest.mark.usefixtures("needs_gemmi")


@pytest.fixture(name="pdb", scope="module", params=["fas2.pqr", "boxb.pqr"])
def fixture_pdb(request, tmp_path_factory):
    """Returns a protein and an RNA with hydrogens as PDB files."""
    path = tmp_path_factory.mktemp("structures") / request.param.replace("pqr", "pdb")
    atoms = eses.read_atoms(DATA / request.param)
    labels = atoms.labels
    names = {"O1P": "OP1", "O2P": "OP2", "CYX": "CYS", "HIE": "HIS", "HID": "HIS", "HIP": "HIS", "HSD": "HIS", "HSE": "HIS"}  # of the PDB
    lines = [f"ATOM  {i + 1:5d} {name if len(name) > 3 else ' ' + name:<4} {residue[:3]:>3} A{int(number):4d}    "
             f"{x:8.3f}{y:8.3f}{z:8.3f}  1.00  0.00          {element:>2}\n"
             for i, (name, residue, number, (x, y, z), element) in enumerate(zip(
                 ["CD1" if (name, residue) == ("CD", "ILE") else names.get(name, name)
                  for name, residue in zip(labels.atom_name, labels.residue)],
                 [names.get(name, name) for name in labels.residue], labels.residue_number, atoms.centers, atoms.element))]
    path.write_text("".join(lines) + "END\n")
    return path


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def test_mdtraj(pdb):
    mdtraj = pytest.importorskip("mdtraj")
    import eses_blocks.mdtraj as drop_in  # pylint: disable=import-outside-toplevel
    one = mdtraj.load(str(pdb), no_boxchk=True, standard_names=False)
    frames = mdtraj.join([one, one])
    frames.xyz[1] *= 1.01
    for mode in ("atom", "residue"):
        for arguments in ({}, {"atom_indices": np.arange(100)}, {"atom_indices": [0] * 50 + [5]},
                          {"atom_indices": []}, {"atom_indices": [-1]}, {"change_radii": {"C": 0.2}, "probe_radius": 0.1}):
            expected, mapping = mdtraj.shrake_rupley(frames, mode=mode, get_mapping=True, **arguments)
            found, same = drop_in.shrake_rupley(frames, mode=mode, get_mapping=True, **arguments)
            np.testing.assert_array_equal(mapping, same)
            assert found.shape == expected.shape and found.dtype == expected.dtype
            np.testing.assert_array_equal(found == -1, expected == -1)
            np.testing.assert_allclose(found, expected, atol=0.05)
            np.testing.assert_allclose(found.sum(), expected.sum(), rtol=0.01)
    assert (drop_in.shrake_rupley(frames, surface="ses").sum(axis=1) < found.sum()).all()
    with pytest.raises(ValueError, match="mode must be one of"):
        drop_in.shrake_rupley(frames, mode="chain")


def test_biopython(pdb):
    database = pytest.importorskip("Bio.PDB")
    sasa = pytest.importorskip("Bio.PDB.SASA")
    from eses_blocks import biopython  # pylint: disable=import-outside-toplevel
    structure = database.PDBParser(QUIET=True).get_structure("x", str(pdb))
    chain = structure[0]["A"]
    residue = next(iter(chain))
    for level, entity in (("S", structure), ("R", chain), ("A", residue)):
        sasa.ShrakeRupley(n_points=200).compute(entity, level=level)
        owners = {"S": [structure], "R": list(chain), "A": list(residue.get_atoms())}[level]
        expected = [owner.sasa for owner in owners]
        biopython.compute(entity, level=level)
        np.testing.assert_allclose([owner.sasa for owner in owners], expected, rtol=0.02, atol=6)
        assert all(owner.ses >= 0 for owner in owners)
    for arguments, message in (((None,), "Invalid entity"), ((chain, "S"), "equal or smaller"), ((chain, "X"), "Invalid level")):
        with pytest.raises(ValueError, match=message):
            biopython.compute(*arguments)


def test_biotite(pdb):
    structure = pytest.importorskip("biotite.structure")
    pdb_io = pytest.importorskip("biotite.structure.io.pdb")
    from eses_blocks import biotite  # pylint: disable=import-outside-toplevel
    array = pdb_io.PDBFile.read(str(pdb)).get_structure(model=1)
    array = array[~np.isin(array.res_name, ["CTE", "NTE"])]  # Biotite does not know these ends
    stack = structure.stack([array, array])
    mask = np.arange(array.array_length()) < 100
    for arguments in ({}, {"atom_filter": mask}, {"vdw_radii": "Single", "probe_radius": 1.2}):
        expected = structure.sasa(array, **arguments)
        found = biotite.sasa(array, **arguments)
        np.testing.assert_array_equal(np.isnan(found), np.isnan(expected))
        np.testing.assert_allclose(found, expected, atol=3)
        np.testing.assert_allclose(np.nansum(found), np.nansum(expected), rtol=0.01)
        np.testing.assert_allclose(biotite.sasa(stack, **arguments), [found, found])
    with pytest.raises(KeyError, match="not a valid radii set"):
        biotite.sasa(array, vdw_radii="mine")


def test_mdanalysis(pdb):
    mda = pytest.importorskip("MDAnalysis")
    from eses_blocks.mdanalysis import SASAAnalysis  # pylint: disable=import-outside-toplevel
    universe = mda.Universe(str(pdb))
    frames = np.array([universe.atoms.positions, 1.01 * universe.atoms.positions, 1.02 * universe.atoms.positions])
    universe.load_new(frames)
    half = f"index 0:{len(universe.atoms) // 2}"
    done = SASAAnalysis(universe, select=half, block="all").run()
    expected = []
    for _ in universe.trajectory:
        expected.append(eses.measure(universe, report=half))
    np.testing.assert_allclose(done.results.total_area, [one.sas_area for one in expected])
    np.testing.assert_allclose(done.results.residue_area.sum(axis=1), done.results.total_area)
    np.testing.assert_allclose(done.results.residue_area[0], expected[0].residues["sas"])
    assert done.results.mean_total_area == pytest.approx(done.results.total_area.mean())
    if "backend" in inspect.signature(SASAAnalysis.run).parameters:  # MDAnalysis 2.8 and later
        parallel = SASAAnalysis(universe, select=half, block="all").run(backend="multiprocessing", n_workers=2)
        np.testing.assert_array_equal(parallel.results.residue_area, done.results.residue_area)
    with pytest.warns(UserWarning, match="block='name ZZ' adds no atoms to select='index 0:9', .* other atoms are \\w+, ") as found:
        SASAAnalysis(universe, select="index 0:9", block="name ZZ")
    assert found[-1].filename == __file__
    alone = SASAAnalysis(universe.atoms, select=half, surface="ses").run(step=2)
    assert alone.results.total_area.shape == (2,)
    universe.trajectory[0]
    assert alone.results.total_area[0] == pytest.approx(eses.measure(universe.select_atoms(half)).ses_area)
