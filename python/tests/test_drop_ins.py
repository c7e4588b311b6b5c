"""Functions in place of those of other libraries, against the originals within their sampling errors."""

import importlib
import warnings

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA, PDB, PROJECT

pytestmark = pytest.mark.usefixtures("needs_gemmi")


# A protein and an RNA with hydrogens, the heavy atoms of a crystal structure and of its dimer, and parts of an enzyme.
STRUCTURES = ("fas2.pqr", "boxb.pqr", "1a8o", "1a8o, assembly 1", *(f"mache.pqr, part {part}" for part in range(6)))
STANDARD_NAMES = {"O1P": "OP1", "O2P": "OP2", "CYX": "CYS", "HIE": "HIS", "HID": "HIS", "HIP": "HIS", "HSD": "HIS", "HSE": "HIS",
                  "NTER": "GLU"}


def read(name):
    """Returns the molecule of a name in STRUCTURES, and the indices of its atoms."""
    source, _, part = name.partition(", ")
    if source == "1a8o":
        molecule = eses.read_molecule(PROJECT / "tests/data/1a8o.cif.gz", assembly="1" if part else "")
        return molecule, molecule.kept
    molecule = eses.read_molecule(DATA / source)
    first = 10 + 85 * int(part[-1]) if part else 0
    rows = (molecule.residue_number >= first) & (molecule.residue_number < (first + 70 if part else np.inf))
    return molecule, np.flatnonzero(rows & ~np.isin(molecule.residue, ["CTE", "NTE"]))  # libraries do not know these ends


def standard_names(molecule, i):
    name, residue = (STANDARD_NAMES.get(text, text) for text in (str(molecule.name[i]), str(molecule.residue[i])))
    return "CD1" if (name, residue) == ("CD", "ILE") else name, residue


@pytest.fixture(name="pdb", scope="module", params=STRUCTURES)
def fixture_pdb(request, tmp_path_factory):
    """Returns a structure as a PDB file."""
    path = tmp_path_factory.mktemp("structures") / "structure.pdb"
    molecule, atoms = read(request.param)
    lines = []
    for serial, i in enumerate(atoms, 1):
        name, residue = standard_names(molecule, i)
        x, y, z = molecule.positions[i]
        chain = "B" if molecule.chain[i] == "A-2" else "A"
        lines.append(f"ATOM  {serial:5d} {name if len(name) > 3 else ' ' + name:<4} {residue:>3} {chain}{molecule.residue_number[i]:4d}    "
                     f"{x:8.3f}{y:8.3f}{z:8.3f}  1.00  0.00          {molecule.element[i].upper():>2}\n")
    path.write_text("".join(lines) + "END\n")
    return path


def require_sampling_errors(exact, sampled, radii, n_points):
    """Requires that sampled areas of atoms deviate from exact ones as numbers of evenly spread points on their spheres do.
    Each point stands for a cell. Only the cells on the boundary of the exposed part are counted wrongly. On a sphere with n
    cells, a cap with the share f of the area has a boundary of the length 4 pi sqrt(f (1 - f)) in radii, and the cells have a
    width of sqrt(4 pi / n): about 4 sqrt(n f (1 - f)) cells. Each has a variance of up to 1/4. A part that is smaller than a
    cell may have a point or none."""
    spheres = 4 * np.pi * np.asarray(radii)**2
    shares = np.clip(exact / spheres, 0, 1)
    variances = (spheres / n_points)**2 * (np.sqrt(n_points * shares * (1 - shares)) + 1)
    deviations = (sampled - exact) / np.sqrt(variances)
    assert np.abs(deviations).max() < 3
    assert np.sqrt(np.mean(deviations**2)) < 0.7
    assert abs((sampled - exact).sum()) < 3 * np.sqrt(variances.sum())


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def test_mdtraj(pdb):
    mdtraj = pytest.importorskip("mdtraj")
    sasa = pytest.importorskip("mdtraj.geometry.sasa")
    import eses_blocks.mdtraj as drop_in  # pylint: disable=import-outside-toplevel
    one = mdtraj.load(str(pdb), no_boxchk=True, standard_names=False)
    frames = mdtraj.join([one, one])
    frames.xyz[1] *= 1.01
    by_atom = drop_in.shrake_rupley(frames)
    for arguments in ({}, {"change_radii": {"C": 0.2}, "probe_radius": 0.1}):
        found, sampled = (function(frames, **arguments) for function in (drop_in.shrake_rupley, mdtraj.shrake_rupley))
        known = sasa._ATOMIC_RADII | arguments.get("change_radii", {})
        radii = [known[atom.element.symbol] + arguments.get("probe_radius", 0.14) for atom in frames.topology.atoms]
        for frame in range(2):
            require_sampling_errors(found[frame], sampled[frame], radii, 960)
    for mode in ("atom", "residue"):
        for indices in (None, np.arange(100), [0] * 50 + [5], [], [-1]):
            expected, mapping = mdtraj.shrake_rupley(frames, mode=mode, get_mapping=True, atom_indices=indices)
            found, same = drop_in.shrake_rupley(frames, mode=mode, get_mapping=True, atom_indices=indices)
            np.testing.assert_array_equal(mapping, same)
            assert found.shape == expected.shape and found.dtype == expected.dtype
            np.testing.assert_array_equal(found == -1, expected == -1)
            if indices is None:
                np.testing.assert_allclose(found[0], np.bincount(mapping, by_atom[0]), rtol=1e-5, atol=1e-6)
    mask = np.arange(one.n_atoms) < 100
    np.testing.assert_array_equal(drop_in.shrake_rupley(one, atom_indices=mask), drop_in.shrake_rupley(one, atom_indices=range(100)))
    assert (drop_in.shrake_rupley(frames, surface="ses").sum(axis=1) < by_atom.sum(axis=1)).all()


def test_biopython(pdb):
    database = pytest.importorskip("Bio.PDB")
    sasa = pytest.importorskip("Bio.PDB.SASA")
    from eses_blocks import biopython  # pylint: disable=import-outside-toplevel
    structure = database.PDBParser(QUIET=True).get_structure("x", str(pdb))
    residues = list(structure[0]["A"])
    for entity, arguments in ((structure, {}), (residues[3], {}),
                              (structure[0]["A"], {"probe_radius": 1.0, "radii_dict": {"C": 2.0}})):
        atoms = list(entity.get_atoms())
        sasa.ShrakeRupley(n_points=100, **arguments).compute(entity)
        sampled = [atom.sasa for atom in atoms]
        biopython.compute(entity, **arguments)
        known = sasa.ATOMIC_RADII | arguments.get("radii_dict", {})
        radii = [known[atom.element] + arguments.get("probe_radius", 1.4) for atom in atoms]
        require_sampling_errors(np.array([atom.sasa for atom in atoms]), sampled, radii, 100)
        assert all(atom.ses >= 0 for atom in atoms)
    for level, owners in (("R", residues), ("C", list(structure[0])), ("S", [structure])):
        biopython.compute(structure, level)
        for owner in owners:
            assert owner.sasa == pytest.approx(sum(atom.sasa for atom in owner.get_atoms()))
            assert owner.ses == pytest.approx(sum(atom.ses for atom in owner.get_atoms()))


def test_biotite(pdb):
    structure = pytest.importorskip("biotite.structure")
    info = pytest.importorskip("biotite.structure.info")
    pdb_io = pytest.importorskip("biotite.structure.io.pdb")
    from eses_blocks import biotite  # pylint: disable=import-outside-toplevel
    array = pdb_io.PDBFile.read(str(pdb)).get_structure(model=1)
    stack = structure.stack([array, array])
    mask = np.arange(array.array_length()) < 100
    radius_of = {"ProtOr": lambda atom: info.vdw_radius_protor(atom.res_name, atom.atom_name) or 1.8,
                 "Single": lambda atom: info.vdw_radius_single(atom.element)}
    for arguments in ({}, {"atom_filter": mask}, {"vdw_radii": "Single", "probe_radius": 1.2},
                      {"vdw_radii": np.full(len(mask), 1.7)}):
        sampled = structure.sasa(array, **arguments)
        found = biotite.sasa(array, **arguments)
        np.testing.assert_array_equal(np.isnan(found), np.isnan(sampled))
        which = arguments.get("vdw_radii", "ProtOr")
        known = radius_of[which] if isinstance(which, str) else lambda atom: 1.7
        shown = ~np.isnan(found)
        radii = [known(atom) + arguments.get("probe_radius", 1.4) for atom in array[shown]]
        require_sampling_errors(found[shown], sampled[shown], radii, 1000)
        np.testing.assert_allclose(biotite.sasa(stack, **arguments), [found, found])


def test_residue_depth(pdb, program, tmp_path):
    """Biopython's depths are distances from vertices, of which eses-msms makes one for each square angstrom. A point of an
    even net of such triangles is at most 0.62 angstrom from a vertex. For an atom 1.4 angstrom below a plane, the distance is
    at most 0.13 angstrom longer than from the nearest point. The vertices of the fine mesh stand for all points."""
    database = pytest.importorskip("Bio.PDB")
    depth = importlib.import_module("Bio.PDB.ResidueDepth")  # Bio.PDB has a class of the same name
    (tmp_path / "eses-msms").symlink_to(program)
    model = database.PDBParser(QUIET=True).get_structure("x", str(pdb))[0]
    coarse = depth.get_surface(model, MSMS=str(tmp_path / "eses-msms"))
    atoms = list(model.get_atoms())
    surface = eses.Surface([atom.coord for atom in atoms], [depth._get_atom_radius(atom) for atom in atoms], 1.5)
    fine = surface.compute(surface.grid(0.25, 1.0)).mesh().vertices
    for residue in list(model.get_residues())[::8]:
        nearest = [np.sqrt(((fine - atom.coord)**2).sum(axis=1).min()) for atom in residue]
        longer = depth.residue_depth(residue, coarse) - np.mean(nearest)
        assert -0.01 < longer < 0.13
    for residue, (mean, _) in depth.ResidueDepth(model, msms_exec=str(tmp_path / "eses-msms")):
        assert mean == pytest.approx(depth.residue_depth(residue, coarse))


@pytest.mark.parametrize("pdb", STRUCTURES[:1], indirect=True)
def test_mdanalysis(pdb, capfd):
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
    with pytest.warns(UserWarning, match="block='name ZZ' adds no atoms to select='index 0:9', .* other atoms are \\w+, ") as found:
        SASAAnalysis(universe, select="index 0:9", block="name ZZ")
    assert found[-1].filename == __file__
    alone = SASAAnalysis(universe.atoms, select=half, surface="ses", verbose=True).run(step=2)
    assert "100%" in capfd.readouterr().err
    assert alone.results.total_area.shape == (2,)
    with pytest.raises(ValueError, match="^no frames are analysed; the trajectory has 3 frames, counted from 0$"):
        SASAAnalysis(universe, select=half).run(start=3)
    universe.trajectory[0]
    assert alone.results.total_area[0] == pytest.approx(eses.measure(universe.select_atoms(half)).ses_area)


def test_mdakit_sasa(pdb):
    mda = pytest.importorskip("MDAnalysis")
    mdakit = pytest.importorskip("mdakit_sasa.analysis.sasaanalysis")
    freesasa = pytest.importorskip("freesasa")
    from eses_blocks.mdanalysis import SASAAnalysis  # pylint: disable=import-outside-toplevel
    freesasa.setVerbosity(freesasa.nowarnings)
    universe = mda.Universe(str(pdb))
    universe.load_new(universe.atoms.positions * np.array([1, 1.02])[:, None, None])
    structure = freesasa.Structure()  # as in mdakit-sasa, which gives FreeSASA the types of the atoms as their names
    for atom in universe.atoms:
        structure.addAtom(atom.type.rjust(2), atom.resname, atom.resnum.item(), atom.segid, *atom.position.tolist())
    radii = [structure.radius(i) for i in range(structure.nAtoms())]
    original = mdakit.SASAAnalysis(universe).run()
    exact = SASAAnalysis(universe, radii=radii).run()
    assert set(original.results) <= set(exact.results) and exact.universe is original.universe
    for name in original.results:
        assert np.shape(exact.results[name]) == np.shape(original.results[name])
    # FreeSASA cuts each atom into 20 slices.
    np.testing.assert_allclose(exact.results.total_area, original.results.total_area, rtol=0.003)
    np.testing.assert_allclose(exact.results.mean_total_area, original.results.mean_total_area, rtol=0.003)
    deviations = exact.results.residue_area - original.results.residue_area
    assert np.abs(deviations).max() < 3 and np.sqrt(np.mean(deviations**2)) < 0.8


@pytest.mark.parametrize("backend", ["multiprocessing", "dask"])
@pytest.mark.parametrize("pdb", STRUCTURES[:1], indirect=True)
def test_mdanalysis_in_parallel(pdb, backend):
    mda = pytest.importorskip("MDAnalysis", "2.8")
    if backend == "dask":
        pytest.importorskip("dask")
    from eses_blocks.mdanalysis import SASAAnalysis  # pylint: disable=import-outside-toplevel
    universe = mda.Universe(str(pdb))
    universe.load_new(universe.atoms.positions * np.linspace(1, 1.04, 5)[:, None, None])
    serial, parallel = (SASAAnalysis(universe, "index 0:199", block="all").run(backend=name, **how)
                        for name, how in (("serial", {}), (backend, {"n_workers": 2})))
    assert len(set(serial.results.total_area)) == 5
    for name in ("total_area", "residue_area", "mean_total_area", "mean_residue_area"):
        np.testing.assert_array_equal(parallel.results[name], serial.results[name])


def test_a_membrane_blocks():
    """A transporter in its membrane: residues lose area where lipids are near, and only there."""
    mda = pytest.importorskip("MDAnalysis")
    files = pytest.importorskip("MDAnalysisTests.datafiles")
    from eses_blocks.mdanalysis import SASAAnalysis  # pylint: disable=import-outside-toplevel
    universe = mda.Universe(files.GRO_MEMPROT, files.XTC_MEMPROT)  # YiiP_lipids
    protein = universe.select_atoms("protein")
    inside, alone = (SASAAnalysis(universe, "protein", **how).run(stop=2).results
                     for how in ({"block": "protein or resname POPE POPG ZNM"}, {}))
    assert inside.residue_area.shape == alone.residue_area.shape == (2, len(protein.residues))
    reach = 2 * (2.75 + 1.4)  # twice the radius of the largest atom and the probe
    for frame, _ in enumerate(universe.trajectory[:2]):
        assert inside.total_area[frame] == pytest.approx(eses.measure(universe, report="protein").sas_area)
        assert alone.total_area[frame] == pytest.approx(eses.measure(protein).sas_area)
        near = universe.select_atoms(f"same residue as (protein and around {reach} not protein)").residues
        is_near = np.isin(protein.residues.ix, near.ix)
        lost = alone.residue_area[frame] - inside.residue_area[frame]
        np.testing.assert_allclose(lost[~is_near], 0, atol=1e-9)
        assert (lost > -1e-9).all() and 0.5 * alone.total_area[frame] > lost[is_near].sum() > 0.2 * alone.total_area[frame]
        assert 0 < is_near.sum() < len(is_near)


def mdtraj_case(path, traj=None, **arguments):
    mdtraj = pytest.importorskip("mdtraj")
    return eses.mdtraj.shrake_rupley(mdtraj.load(str(path)) if traj is None else traj, **arguments)


def biopython_case(path, entity=None, **arguments):
    database = pytest.importorskip("Bio.PDB")
    structure = database.PDBParser(QUIET=True).get_structure("x", str(path))
    return eses.biopython.compute(structure[0]["A"] if entity is None else entity, **arguments)


def biotite_case(path, array=None, **arguments):
    pdb_io = pytest.importorskip("biotite.structure.io.pdb")
    return eses.biotite.sasa(pdb_io.PDBFile.read(str(path)).get_structure(model=1) if array is None else array, **arguments)


def mdanalysis_case(path, universe=None, **arguments):
    mda = pytest.importorskip("MDAnalysis")
    return eses.mdanalysis.SASAAnalysis(mda.Universe(str(path)) if universe is None else universe, **arguments)


@pytest.mark.parametrize(("call", "arguments", "error", "message"), [
    (mdtraj_case, {"traj": 5}, TypeError, "traj must be a Trajectory of MDTraj, not 5$"),
    (mdtraj_case, {"mode": "chain"}, ValueError, "mode must be 'atom' or 'residue', not 'chain'$"),
    (mdtraj_case, {"mode": 5}, TypeError, "mode must be a text, not 5$"),
    (mdtraj_case, {"surface": "vdw"}, ValueError, "surface must be 'sas' or 'ses', not 'vdw'$"),
    (mdtraj_case, {"probe_radius": "x"}, TypeError, "probe_radius must be a number, not 'x'$"),
    (mdtraj_case, {"get_mapping": "x"}, TypeError, "get_mapping must be True or False, not 'x'$"),
    (mdtraj_case, {"change_radii": 5}, TypeError, "change_radii must be a mapping of elements to radii, not 5$"),
    (mdtraj_case, {"change_radii": {"C": "x"}}, TypeError, "change_radii: the radius of 'C' must be a number, not 'x'$"),
    (mdtraj_case, {"change_radii": {"C": -1}}, ValueError, "change_radii: the radius of 'C' must be finite and not negative, not -1$"),
    (mdtraj_case, {"atom_indices": "A"}, TypeError, "atom_indices must be a mask or indices of atoms, not 'A'$"),
    (mdtraj_case, {"atom_indices": [0.5]}, TypeError, r"atom_indices must be a mask or indices of atoms, not \[0.5\]$"),
    (mdtraj_case, {"atom_indices": [13]}, IndexError, "atom_indices: there are 13 atoms, and no atom 13, counted from 0$"),
    (mdtraj_case, {"atom_indices": np.ones(3, bool)}, ValueError, r"atom_indices: a mask must have shape \(13,\), .* not \(3,\)$"),
    (biopython_case, {"entity": 5}, ValueError, "entity must be a Residue, Chain, Model or Structure of Biopython, not 5$"),
    (biopython_case, {"level": "residue"}, ValueError, "level must be 'A', 'R', 'C', 'M' or 'S', not 'residue'$"),
    (biopython_case, {"level": "S"}, ValueError, "level must be that of the entity, 'C', or one below it, not 'S'$"),
    (biopython_case, {"radii_dict": [1.7]}, TypeError, r"radii_dict must be a mapping of elements to radii, not \[1.7\]$"),
    (biopython_case, {"threads": "x"}, TypeError, "threads must be a whole number, not 'x'$"),
    (biotite_case, {"array": "1abc.pdb"}, TypeError, "array must be an AtomArray or AtomArrayStack of Biotite, not '1abc.pdb'$"),
    (biotite_case, {"atom_filter": "A"}, TypeError, "atom_filter must be a mask of atoms, not 'A'$"),
    (biotite_case, {"atom_filter": [True]}, ValueError, r"atom_filter: a mask must have shape \(13,\), .* not \(1,\)$"),
    (biotite_case, {"vdw_radii": "bondi"}, KeyError, "\"vdw_radii must be 'ProtOr', 'Single' or an array of radii, not 'bondi'"),
    (biotite_case, {"vdw_radii": [1.7]}, ValueError, r"vdw_radii must have shape \(13,\), one for each atom, not \(1,\)$"),
    (biotite_case, {"vdw_radii": [np.nan] * 13}, ValueError, r"vdw_radii: atom 0 \(counted from 0\) has radius nan; give a finite"),
    (biotite_case, {"ignore_ions": "x"}, TypeError, "ignore_ions must be True or False, not 'x'$"),
    (mdanalysis_case, {"universe": 5}, TypeError, "universe_or_atomgroup must be a Universe or AtomGroup of MDAnalysis, not 5$"),
    (mdanalysis_case, {"select": 5}, TypeError, "select must be a text such as 'protein', not 5$"),
    (mdanalysis_case, {"select": "protien"}, ValueError, "select: Unknown selection token: 'protien'$"),
    (mdanalysis_case, {"block": "protien"}, ValueError, "block: Unknown selection token: 'protien'$"),
    (mdanalysis_case, {"select": "name ZZ"}, ValueError, "select: no atoms in 'name ZZ'; the residues are ALA, SER, ZN, HOH$"),
    (mdanalysis_case, {"radi": "bondi"}, TypeError, "unknown argument 'radi'; did you mean radii.$"),
    (mdanalysis_case, {"surfaces": "ses"}, TypeError, "unknown argument 'surfaces'; did you mean surface.$"),
    (mdanalysis_case, {"waters": "x"}, TypeError, "waters must be True or False, not 'x'$"),
])
def test_wrong_arguments(tmp_path, call, arguments, error, message):
    path = tmp_path / "two.pdb"
    path.write_text(PDB)
    with pytest.raises(error, match=f"^{message}"):
        call(path, **arguments)
