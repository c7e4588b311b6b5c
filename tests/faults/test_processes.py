"""Tests of runs that several processes share: they write the same files as one process, or none."""

import errno
import fcntl
import gzip
import json
import os
import shutil
import signal
import subprocess
import unittest

from faults import (LIBRARY, MMCIF, FaultTest, SMALL, forget_signals, needs_library, wait_for,
                    write_pdb)
from support import DATA, PROGRAM, needs_gemmi, write_program

LAUNCHER = os.environ.get("ESES_MPIEXEC")
IS_OPEN_MPI = LAUNCHER and any(name in subprocess.run(
    [LAUNCHER, "--version"], capture_output=True, check=False).stdout
    for name in (b"Open MPI", b"OpenRTE"))
# Options of Open MPI: more processes than processors, root is allowed, and no network drivers,
# whose search takes longer than these runs.
FLAGS = ["--oversubscribe", "--mca", "btl", "self,vader"] if IS_OPEN_MPI else []
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
CHECKPOINT = ".eses-blocks.resume"


class Processes(FaultTest):
    def setUp(self):
        super().setUp()
        self.alone = self.folder / "alone"

    def start_together(self, count, *arguments, program=PROGRAM, text=True, **how):
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE,
                   "stderr": subprocess.PIPE, **how}
        launched = subprocess.Popen(
            [LAUNCHER, "-n", str(count), *FLAGS, program, *map(str, arguments),
             "-o", self.output], env={**os.environ, **ENVIRONMENT}, text=text,
            preexec_fn=forget_signals, **streams)
        self.addCleanup(self.end, launched)
        return launched

    def run_together(self, count, *arguments, **how):
        return self.finish(self.start_together(count, *arguments, **how))

    def run_alone(self, *arguments):
        return subprocess.run([PROGRAM, *map(str, arguments), "-o", self.alone], check=False,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True)

    def assertSame(self, count, *arguments, options=(), mesh=None):
        """Checks that several processes write the same output and files as one process, byte for
        byte. `mesh` is the name of a mesh among the files."""
        def mesh_in(folder):
            return ("--mesh", folder / mesh) if mesh else ()
        alone = self.run_alone(*arguments, "-q", *mesh_in(self.alone))
        self.assertDone(alone)
        together = self.run_together(count, *arguments, "-q", "-t", "1", *options,
                                     *mesh_in(self.output))
        self.assertDone(together)
        self.assertEqual(together.stdout, alone.stdout)
        self.assertEqual(self.all_files(), self.all_files(self.alone))
        self.assertTrue(self.contents() == self.contents(self.alone))
        for folder in (self.output, self.alone):
            shutil.rmtree(folder, ignore_errors=True)

    def big_run(self, spacing="0.05", chosen="areas"):
        path = self.folder / "big.xyzr"
        path.write_text("".join(f"{x * 3} {y * 3} {z * 3} 1.7\n"
                                for x in range(14) for y in range(14) for z in range(40)))
        return (path, "-q", "--spacing", spacing, "-t", "1", "-b", "33", "--write", chosen)

    def processes_of(self, launched):
        """Returns the process ids of the program below the launcher."""
        found = subprocess.run(["pgrep", "-P", str(launched.pid), "-f", "eses-blocks"],
                               capture_output=True, text=True, check=False)
        return [int(number) for number in found.stdout.split()]

    def has_temporaries(self):
        return any(name.endswith(".part") for name in self.all_files())

    def assertNothing(self):
        self.assertEqual(self.all_files(), [])

    def assertEnded(self, done, message, code=1):
        self.assertEqual(done.returncode, code, done)
        errors = [line for line in done.stderr.splitlines()
                      if line.startswith("eses-blocks: error: ")]
        self.assertEqual(len(errors), 1, done.stderr)
        self.assertIn(message, errors[0])
        self.assertNotIn("area:", done.stdout)


class Identity(Processes):
    def test_files_do_not_depend_on_processes_and_blocks(self):
        for count in range(1, 6):
            for name, spacing, block in (("1ubq.xyzr", 0.5, 64), ("c60.xyzr", 0.3, 9),
                                         ("1a0q.xyzr", 0.8, 17)):
                with self.subTest(count=count, name=name):
                    self.assertSame(count, DATA / name, "--spacing", spacing,
                                    options=("-b", block))

    def test_pqr_input_gives_the_same_files(self):
        self.assertSame(3, DATA / "fas2.pqr", "--spacing", "0.7")

    def test_more_processes_than_layers_give_the_same_files(self):
        self.assertSame(5, SMALL, "--spacing", "0.8", options=("-b", "500"))

    def test_more_processes_than_planes_give_the_same_files(self):
        path = self.folder / "one.xyzr"
        path.write_text("0 0 0 1\n")
        self.assertSame(7, path, "--spacing", "2", "--margin", "1")

    def test_isolated_atoms_give_the_same_files(self):
        """Some slabs have no atom near them."""
        path = self.folder / "far.xyzr"
        path.write_text("".join(f"0 0 {z} 1.5\n" for z in (200, 0, 90)))
        for count in (2, 3, 5):
            self.assertSame(count, path, "--spacing", "0.9")

    def test_large_atom_gives_the_same_files(self):
        path = self.folder / "large.xyzr"
        path.write_text("0 0 0 30\n" + "".join(
            f"{31 * x} {31 * y} {31 * z} 1.7\n" for x in (-1, 0, 1) for y in (-1, 0, 1)
            for z in (-1, 0, 1)))
        self.assertSame(4, path, "--spacing", "1.5", "--margin", "2")

    def test_compressed_files_are_the_same(self):
        self.assertSame(3, DATA / "1ubq.xyzr", "--spacing", "0.6", "--gzip")
        path = self.folder / "nothing.xyzr"
        path.write_text("0.3 0.2 0.1 0\n5 5 5 0\n")
        self.assertSame(2, path, "--spacing", "3", "--margin", "4", "--gzip")

    def test_region_has_the_same_files(self):
        self.assertSame(3, DATA / "1ubq.xyzr", "--spacing", "0.6", "--blocks", "0:1,0:2,1:4",
                        "-b", "17")

    def test_filled_cavities_are_the_same(self):
        """Each process finds the cavities of all atoms."""
        for count in (2, 3, 5):
            self.assertSame(count, DATA / "1a0q.xyzr", "--spacing", "0.7", "--fill-cavities",
                            options=("-b", "23"))
            self.assertSame(count, DATA / "1ubq.xyzr", "--spacing", "0.5", "--fill-cavities=14",
                            mesh="mesh.ply")
        self.assertSame(3, DATA / "1ubq.xyzr", "--spacing", "0.6", "--blocks", "0:1,0:2,1:4",
                        "-b", "17", "--fill-cavities")

    def test_chosen_files_are_the_same(self):
        for chosen in ("grid", "edges", "areas", "none"):
            with self.subTest(chosen=chosen):
                self.assertSame(2, SMALL, "--write", chosen)

    def test_maps_are_the_same(self):
        for count in (2, 3, 5):
            self.assertSame(count, DATA / "1ubq.xyzr", "--spacing", "0.6", "--inside", "map.dx")
            self.assertSame(count, DATA / "c60.xyzr", "--spacing", "0.3", "--inside", "map.vti",
                            "--write", "none", options=("-b", "9"))
        self.assertSame(3, DATA / "1ubq.xyzr", "--spacing", "0.5", "--blocks", "1:3,0:2,1:4",
                        "-b", "17", "--inside", "map.dx", "--gzip")

    def test_maps_for_solvers_are_the_same(self):
        """Maps of points and of edges, plain and compressed."""
        maps = ("--dielectric", "diel_", "--write", "none", "--spacing", "0.4")
        for count in range(1, 6):
            for block in (8, 33, 128):
                with self.subTest(count=count, block=block):
                    self.assertSame(count, DATA / "1ubq.xyzr", *maps, "--kappa", "kappa.dx",
                                    "--inside", "inside.dx", options=("-b", block))
            self.assertSame(count, DATA / "1ubq.xyzr", *maps, "--kappa", "kappa.dx.gz", "--inside",
                            "inside.dx.gz", "--gzip")

    @needs_gemmi
    def test_files_from_structures_are_the_same(self):
        """PDB and mmCIF files."""
        for path in (MMCIF, write_pdb(self.folder / "chains.pdb")):
            for count in (2, 3, 5):
                self.assertSame(count, path, "--spacing", "0.8", "--write",
                                "all,residues", "--color", "chain", mesh="mesh.ply")

    def test_meshes_are_the_same(self):
        """Triangles between two slabs have vertices of both."""
        for count in (2, 3, 4, 5):
            for mesh in ("mesh.ply", "mesh.obj", "mesh.off", "mesh.vert", "mesh.vtp", "mesh.stl",
                         "mesh.glb"):
                with self.subTest(count=count, mesh=mesh):
                    self.assertSame(count, SMALL, "--spacing", "0.4", mesh=mesh,
                                    options=("-b", str(5 + 3 * count)))
        self.assertSame(3, DATA / "1ubq.xyzr", "--spacing", "0.6", "--color", "patch",
                        mesh="mesh.ply")
        for mesh, *more in (("mesh.ply",), ("mesh.ply", "--ply-ascii"), ("mesh.vtp",),
                            ("mesh.glb",)):
            self.assertSame(3, DATA / "1ubq.xyzr", "--spacing", "0.6", "--color", "atom", "--write",
                            "none", *more, mesh=mesh)

    def test_meshes_of_components_are_the_same(self):
        """Each process finds the cavities of all atoms."""
        for count in (2, 3):
            for mesh, more in (("mesh.ply", ("--color", "component", "--write", "none")),
                               ("mesh.vtp", ("--color", "component", "--component", "1")),
                               ("mesh.ply", ("--component", "outside", "--mesh-quality"))):
                with self.subTest(count=count, mesh=mesh, more=more):
                    self.assertSame(count, DATA / "1ubq.xyzr", "--spacing", "0.6", *more,
                                    mesh=mesh)

    def test_quality_meshes_are_the_same(self):
        for count in (2, 3, 5):
            for mesh in ("mesh.ply", "mesh.vert", "mesh.vtp", "mesh.stl"):
                with self.subTest(count=count, mesh=mesh):
                    self.assertSame(count, SMALL, "--spacing", "0.4", "--mesh-quality", mesh=mesh,
                                    options=("-b", str(5 + 3 * count)))

    def test_meshes_of_parts_are_the_same(self):
        for blocks in ("1:3,0:2,1:4", "0:4,0:4,0:1", "1:2,1:2,2:4"):
            with self.subTest(blocks=blocks):
                self.assertSame(3, DATA / "1ubq.xyzr", "--spacing", "0.5", "--blocks", blocks,
                                "-b", "17", mesh="mesh.off")

    def test_meshes_of_few_planes_are_the_same(self):
        path = self.folder / "one.xyzr"
        path.write_text("0 0 0 1\n")
        self.assertSame(7, path, "--spacing", "0.9", "--margin", "0.9", "--inside", "map.dx",
                        mesh="mesh.off")
        for mesh in ("mesh.off", "mesh.face", "mesh.vtp"):
            self.assertSame(3, path, "--spacing", "0.3", "--region=-2,-2,0,2,2,0.35", mesh=mesh)

    def test_residues_are_the_same(self):
        for count in (2, 3, 5):
            self.assertSame(count, DATA / "fas2.pqr", "--spacing", "0.8", "--write",
                            "all,residues", "--color", "chain", mesh="mesh.ply")
            self.assertSame(count, DATA / "fas2.pqr", "--spacing", "0.8", "--write", "none",
                            "--color", "chain", mesh="mesh.vtp")

    @needs_gemmi
    def test_tables_of_atoms_are_the_same(self):
        """With and without names, plain and compressed."""
        compressed = self.folder / "fas2.pqr.gz"
        compressed.write_bytes(gzip.compress((DATA / "fas2.pqr").read_bytes()))
        late = self.folder / "late.xyzr"
        late.write_text("# a comment\n" * 100 + "0 0 0 1.5\n9 0 0 1.7\n")
        for path in (DATA / "fas2.pqr", DATA / "1ubq.xyzr", MMCIF, compressed, late,
                     write_pdb(self.folder / "chains.pdb")):
            for count in (2, 3, 5):
                with self.subTest(path=path, count=count):
                    self.assertSame(count, path, "--spacing", "0.9", "--write", "residues,atoms"
                                    if "xyzr" not in path.name else "atoms", options=("-b", "9"))

    def write_pqr(self, labels):
        """Writes atoms on a winding line with these chains, residues and numbers."""
        path = self.folder / "labels.pqr"
        path.write_text("".join(
            f"ATOM {i} C {residue} {chain} {number} {3 * (i % 5)} {3 * (i // 5 % 5)} "
            f"{2.5 * (i // 25)} 0 1.7\n" for i, (chain, residue, number) in enumerate(labels)))
        return path

    def test_residues_that_processes_share_are_the_same(self):
        """Cases: one residue for all atoms; residues in the slabs of several processes; chains and
        residues that occur again."""
        every = [("A", "ALA", 1)] * 60
        long = [("A", "ALA", 1)] * 3 + [("B", "GLY", 7)] * 50 + [("A", "SER", 2)] * 7
        again = [("ABCABD"[i // 5 % 6], "ALA" if i % 3 else "GLY", i // 10 % 4) for i in range(60)]
        single = [("A", "HOH", i) for i in range(60)]
        # PLY cuts names at 64 characters, so these are two residues with one name.
        suspicious = [("A,B\"", "X" * (70 + i // 30), i // 40) for i in range(60)]
        for labels in (every, long, again, single, suspicious):
            path = self.write_pqr(labels)
            for count in (2, 3, 5, 7):
                with self.subTest(first=labels[:7], count=count):
                    self.assertSame(count, path, "--spacing", "1", "--margin", "1", "--write",
                                    "residues", "--color", "chain", mesh="mesh.ply")
                    self.assertSame(count, path, "--spacing", "1", "--margin", "1", "--write",
                                    "none", mesh="mesh.vtp")

    def test_mesh_in_another_directory_is_the_same(self):
        """The directory may be reached through a link."""
        places = [self.folder / "meshes" / name for name in ("alone.off", "together.off")]
        places[0].parent.mkdir()
        (self.folder / "link.off").symlink_to(places[1])
        arguments = (SMALL, "-q", "--write", "none", "--mesh")
        self.assertDone(self.run_alone(*arguments, places[0]))
        self.assertDone(self.run_together(3, *arguments, self.folder / "link.off"))
        self.assertEqual(places[0].read_bytes(), places[1].read_bytes())
        self.assertTrue((self.folder / "link.off").is_symlink())

    def test_compressed_input_gives_the_same_files(self):
        path = self.folder / "c60.xyzr.gz"
        path.write_bytes(gzip.compress(SMALL.read_bytes()))
        self.assertSame(2, path)

    def test_text_that_is_hard_to_divide_gives_the_same_files(self):
        """The text has lines of very different length, comments, CRLF, and no newline at the
        end."""
        path = self.folder / "suspicious.xyzr"
        lines = [f"{3 * i} 0 {i % 7} 1.5 {'x' * (997 * i % 3000)}" for i in range(40)]
        path.write_bytes("\r\n".join(["# " + "c" * 4000, "", *lines]).encode())
        for count in (2, 3, 5):
            self.assertSame(count, path, "--spacing", "0.9")

    def test_diagnostics_are_the_same(self):
        """Pairs of atoms with a diagnostic may be anywhere in the file and in space."""
        path = self.folder / "suspicious.xyzr"
        atoms = [f"{i % 5 * 4} {i // 5 % 5 * 4} {i // 25 * 4} 1.5" for i in range(250)]
        suspicious = atoms[::20] + ["0.2 0 0 1.5", "8 8 20.1 0.3", "8 8 8.3 1.5", "0 0 36 4.5", "8 8 16 0"]
        path.write_text("\n".join(atoms + suspicious) + "\n")
        arguments = (path, "--spacing", "0.9", "--margin", "0.9", "--json")
        alone = json.loads(self.run_alone(*arguments).stdout)
        self.assertGreater(len(alone["diagnostics"]), 3)
        for count in (2, 4):
            together = json.loads(self.run_together(count, *arguments).stdout)
            for key in ("diagnostics", "area", "volume", "crossings", "area_by_kind",
                        "inside_points", "grid", "atoms"):
                self.assertEqual(together[key], alone[key], key)
            self.assertEqual(len(together["processes"]), count)
            self.assertEqual(sum(p["planes"] for p in together["processes"]),
                             alone["grid"]["size"][2])

    def test_diagnostics_of_atoms_far_from_the_points_are_the_same(self):
        """Slabs have only the atoms near the points to compute, but diagnostics are of all atoms."""
        path = self.folder / "far.xyzr"
        path.write_text("0 0 0 1.5\n0 0 0 1.5\n50 50 50 1.5\n50 50 90 0\n0 0 -70 5\n"
                        "50 50 120 1.5\n50 50 120.1 1.5\n50 50 -900 0\n")
        parts = (("--region=45,45,45,55,55,55",),
                 ("--grid-center", "50,50,50", "--grid-points", "9,9,9"),
                 ("--grid-center", "50,50,500", "--grid-points", "9,9,9"))
        for part in parts:
            arguments = (path, "--spacing", "0.8", "--write", "areas", *part)
            alone = json.loads(self.run_alone(*arguments, "--json").stdout)
            of_atoms = {found["kind"]: found["count"] for found in alone["diagnostics"] if found["count"]}
            self.assertEqual(of_atoms, {"duplicate": 1, "close": 1, "large_radius": 1, "zero_radius": 2})
            self.assertEqual(self.run_alone(*arguments, "--strict").returncode, 1)
            for count in (2, 3, 5):
                with self.subTest(part=part, count=count):
                    together = json.loads(self.run_together(count, *arguments, "--json").stdout)
                    for key in ("diagnostics", "area", "crossings", "inside_points", "atoms"):
                        self.assertEqual(together[key], alone[key], key)
                    strict = self.run_together(count, *arguments, "--strict")
                    self.assertEqual(strict.returncode, 1)
                    self.assertEqual(strict.stderr.count("eses-blocks: error: "),
                                     self.run_alone(*arguments, "--strict").stderr.count("error: "))
                    self.assertSame(count, *arguments)

    def test_small_grid_in_a_large_molecule_needs_few_atoms(self):
        path = self.folder / "rod.xyzr"
        path.write_text("".join(f"{i % 3 * 3} 0 {i} 1.5\n" for i in range(2000)))
        done = self.run_together(4, path, "--spacing", "0.5", "--grid-center", "3,0,1000",
                                 "--grid-points", "17,17,17", "--write", "none", "--json")
        for share in json.loads(done.stdout)["processes"]:
            self.assertLess(share["atoms"], 100)

    def test_each_process_holds_a_part_of_the_atoms(self):
        """No process holds all atoms."""
        path = self.folder / "rod.xyzr"
        path.write_text("".join(f"{i % 3 * 3} 0 {i} 1.5\n" for i in range(2000)))
        done = self.run_together(4, path, "--spacing", "1", "--margin", "1", "--json")
        shares = json.loads(done.stdout)["processes"]
        for share in shares:
            self.assertLess(share["atoms"], 2000 / 4 + 100)
        self.assertLess(max(p["planes"] for p in shares), 1.1 * 2000 / 4)

    def test_verification_has_the_same_size(self):
        """All processes together check as many points and edges as one process, and write the
        same files."""
        self.assertSame(3, DATA / "1ubq.xyzr", "--spacing", "0.5", options=("--verify",))
        done = self.run_together(3, DATA / "1ubq.xyzr", "--verify=500", "--json")
        self.assertEqual(json.loads(done.stdout)["verification"],
                         {"points": 500, "edges": 500, "faults": []})

    def test_dry_run_plans_the_same_grid(self):
        alone = self.run_alone(SMALL, "--dry-run", "--json")
        done = self.run_together(2, SMALL, "--dry-run", "--json")
        self.assertDone(done)
        self.assertEqual(json.loads(done.stdout)["grid"], json.loads(alone.stdout)["grid"])
        self.assertNothing()

    def test_help_is_printed_once(self):
        done = self.run_together(3, "--version")
        self.assertDone(done)
        self.assertEqual(done.stdout.count("eses-blocks "), 1)


class Failure(Processes):
    def test_pipes_are_refused(self):
        """All processes read the file, but a pipe can be read once only."""
        pipe = self.folder / "pipe.xyzr"
        os.mkfifo(pipe)
        for path, name in (("-", "standard input"), (pipe, "pipe.xyzr")):
            self.assertEnded(self.run_together(2, path, "-q"), f"{name} in several processes")
            self.assertNothing()

    def test_bad_line_is_reported_wherever_it_is(self):
        lines = [f"{3 * i} 0 0 1.5" for i in range(300)]
        for number in (1, 150, 300):
            path = self.folder / "bad.xyzr"
            path.write_text("\n".join([*lines[:number - 1], "1 2 x 1", *lines[number:], "z"]))
            alone = self.run_alone(path)
            done = self.run_together(3, path)
            self.assertEnded(done, f"bad.xyzr:{number}: ")
            self.assertIn(alone.stderr.strip(), done.stderr)
            self.assertNothing()

    def test_unreadable_input_is_an_error(self):
        empty = self.folder / "empty.xyzr"
        empty.write_text("# nothing\n")
        for path in (self.folder / "missing.xyzr", self.folder, empty):
            done = self.run_together(2, path)
            self.assertEnded(done, self.run_alone(path).stderr.strip().removeprefix(
                "eses-blocks: error: "))

    def test_more_atoms_than_the_memory_limit_allows_are_refused(self):
        path = self.folder / "many.xyzr"
        path.write_text("1 2 3 1.5\n" * 2_600_000)
        done = self.run_together(2, path, "--max-memory", "100M")
        self.assertEnded(done, "exceeds the memory limit of 100 MiB")
        self.assertNothing()

    def test_usage_errors_are_printed_once(self):
        self.assertEnded(self.run_together(2, SMALL, "--spacing", "x"), "--spacing", code=2)
        self.assertEnded(self.run_together(2, SMALL, "--write", "residues"),
                         "--write residues needs a PQR, PDB or mmCIF file", code=2)
        self.assertEnded(self.run_together(2, SMALL, "--mesh", "x.ply", "--color", "chain"),
                         "--color chain needs a PQR, PDB or mmCIF file", code=2)
        self.assertEnded(self.run_together(2, SMALL, "--exact"),
                         "--exact needs all atoms in one process", code=2)

    @needs_gemmi
    def test_names_give_the_diagnostics_of_one_process(self):
        water = self.folder / "wet.pqr"
        water.write_text("".join(f"ATOM {i} O {'HOH' if i % 3 else 'ALA'} {i} {9 * i} 0 0 -0.8 1.6\n"
                                 for i in range(40)))
        trace = self.folder / "trace.pdb"
        write_pdb(trace)
        trace.write_text("".join(line for line in trace.read_text().splitlines(keepends=True)
                                 if " CA " in line))
        for path, kind in ((water, "water"), (trace, "one_atom_residue")):
            alone = json.loads(self.run_alone(path, "--json", "--write", "none").stdout)
            self.assertIn(kind, [one["kind"] for one in alone["diagnostics"]])
            for count in (2, 3):
                together = self.run_together(count, path, "--json", "--write", "none")
                self.assertDone(together)
                self.assertEqual(json.loads(together.stdout)["diagnostics"], alone["diagnostics"])

    def test_strict_refuses_warnings(self):
        path = self.folder / "suspicious.xyzr"
        path.write_text("0 0 0 1.5\n0 0 0 1.5\n")
        self.assertEnded(self.run_together(2, path, "--strict"), "suspicious.xyzr: 1 atom")
        self.assertNothing()

    def test_locked_directory_is_refused(self):
        self.output.mkdir()
        with open(self.output / ".eses-blocks.lock", "w", encoding="ascii") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            self.assertEnded(self.run_together(2, SMALL), "another run is writing there")

    def test_directory_that_cannot_be_created_is_an_error(self):
        self.output.write_text("a file")
        self.assertEnded(self.run_together(2, SMALL), "cannot write into")

    def run_with_other_place(self, place, content):
        """Runs two processes, the second of which sees a file system of its own at `place`."""
        body = (f"mount -t tmpfs none {place} && "
                f"{{ [ -z '{content}' ] || echo '{content}' > {place}/in.xyzr; }} && ")
        wrapper = write_program(
            self.folder / "elsewhere",
            "if [ \"$OMPI_COMM_WORLD_RANK$PMI_RANK\" = 1 ]; then\n"
            f"  exec unshare -m sh -c \"{body}exec {PROGRAM} \\\"\\$@\\\"\" sh \"$@\"\nfi\n"
            f"exec {PROGRAM} \"$@\"\n")
        if subprocess.run(["unshare", "-m", "true"], capture_output=True,
                          check=False).returncode != 0:
            self.skipTest("may not have mounts of its own")
        folder = self.folder / "input"
        folder.mkdir(exist_ok=True)
        shutil.copy(SMALL, folder / "in.xyzr")
        self.output.mkdir(exist_ok=True)
        return self.run_together(2, folder / "in.xyzr", program=wrapper)

    def test_machines_with_different_directories_are_refused(self):
        self.assertEnded(self.run_with_other_place(self.output, ""), "same directory")
        self.assertNothing()

    def test_machines_with_different_files_are_refused(self):
        done = self.run_with_other_place(self.folder / "input", "")
        self.assertEnded(done, "in.xyzr")
        done = self.run_with_other_place(self.folder / "input", "1 2 3 4")
        self.assertEnded(done, "not the file that the first process reads")

    def test_kill_while_files_are_merged_ends_all(self):
        arguments = self.big_run("0.1", "edges")
        launched = self.start_together(3, *arguments)
        wait_for(lambda: launched.poll() is not None or any(
            name.startswith(".intersection_info") and (self.output / name).stat().st_size > 0
            for name in self.all_files()))
        victims = self.processes_of(launched)
        if len(victims) != 3:
            self.skipTest("it was over too soon")
        os.kill(victims[1], signal.SIGKILL)
        # The other processes do not wait for the killed one.
        self.assertNotEqual(self.finish(launched).returncode, 0)
        # The first process may have renamed all files before it was ended.
        self.assertIn([n for n in self.all_files() if not n.startswith(".")],
                      ([], ["bounding_box.txt", "intersection_info.txt"]))

    def test_full_disk_of_one_process_ends_all(self):
        """The disk is full in any of the processes, while chunks are written and while they are
        merged."""
        arguments = (SMALL, "-q", "--spacing", "0.4", "--write", "grid")
        self.assertDone(self.run_alone(*arguments))
        needed = (self.alone / "grid_info.txt").stat().st_size
        self.output.mkdir()
        for size in (needed // 2, needed * 3 // 2):  # chunks are beside the file
            mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none",
                                      self.output], capture_output=True, check=False)
            if mounted.returncode != 0:
                self.skipTest("may not mount a file system")
            try:
                self.assertEnded(self.run_together(2, *arguments), "")
                wait_for(lambda: not self.has_temporaries())
                self.assertNothing()
            finally:
                subprocess.run(["umount", self.output], check=True)

    @needs_library
    def test_failure_of_all_processes_is_reported_once(self):
        """All processes fail to write a chunk, at about the same time."""
        wrapper = write_program(
            self.folder / "full", f"LD_PRELOAD={LIBRARY} ESES_FAULT='write 2 stay={errno.ENOSPC}' "
            f"exec {PROGRAM} \"$@\"\n")
        for count in (2, 5):
            done = self.run_together(count, SMALL, "-q", "--spacing", "0.4", "--resume",
                                     program=wrapper)
            self.assertEnded(done, "No space left")

    def test_failing_allocation_of_one_process_ends_all(self):
        """A limit leaves one of the processes step by step more memory."""
        path = self.folder / "many.xyzr"
        path.write_text("".join(f"{i % 50 * 3} {i // 50 % 50 * 3} {i // 2500 * 3} 1.5\n"
                                for i in range(50000)))
        found = False
        for limit in range(200_000, 900_000, 20_000):  # KiB of address space
            wrapper = write_program(
                self.folder / "limited",
                f"if [ \"$OMPI_COMM_WORLD_RANK$PMI_RANK\" = 1 ]; then ulimit -v {limit}; fi\n"
                f"exec {PROGRAM} \"$@\"\n")
            done = self.run_together(2, path, "-q", "--spacing", "0.5", "-t", "1",
                                     "--write", "areas", program=wrapper)
            if done.returncode == 0:
                break
            self.assertEqual([n for n in self.all_files() if not n.startswith(".")], [])
            found = found or "out of memory" in done.stderr
        self.assertEqual(done.returncode, 0)
        if not found:
            self.skipTest("no limit left enough memory to start, and too little to go on")

    def test_killed_process_ends_all(self):
        """The other processes end at once, and no file gets its final name."""
        arguments = self.big_run()
        for which in (0, -1):
            launched = self.start_together(3, *arguments)
            # The killed run may have left temporary files.
            wait_for(lambda: self.has_temporaries() and len(self.processes_of(launched)) == 3)
            os.kill(self.processes_of(launched)[which], signal.SIGKILL)
            done = self.finish(launched)
            self.assertNotEqual(done.returncode, 0)
            self.assertEqual([n for n in self.all_files() if not n.startswith(".")], [])
        self.assertSame(2, SMALL)  # the next run removes the rest

    def test_sigterm_ends_all(self):
        launched = self.start_together(3, *self.big_run())
        wait_for(self.has_temporaries)
        launched.send_signal(signal.SIGTERM)
        self.assertNotEqual(self.finish(launched).returncode, 0)
        wait_for(lambda: not self.has_temporaries())
        self.assertEqual([n for n in self.all_files() if not n.startswith(".")], [])


class Resume(Processes):
    def chunks(self):
        return [name for name in self.all_files(self.output / CHECKPOINT) if name.endswith(".sums")]

    def test_other_numbers_of_processes_continue_a_run(self):
        """Three processes, or one, continue a run of two. The files are those of one process."""
        arguments = (*self.big_run("0.15", "edges"), "--inside", "map.vti")
        self.assertDone(self.run_alone(*arguments, "--mesh", self.alone / "mesh.ply"))
        arguments = (*arguments, "--mesh", self.output / "mesh.ply")
        for count in (1, 3):
            launched = self.start_together(2, *arguments, "--resume")
            wait_for(lambda: len(self.chunks()) > 3)
            for victim in self.processes_of(launched):
                os.kill(victim, signal.SIGKILL)
            self.finish(launched)
            self.assertGreater(len(self.chunks()), 3)
            self.assertDone(self.run_together(count, *arguments, "--resume"))
            self.assertEqual(self.all_files(), self.all_files(self.alone))
            self.assertTrue(self.contents() == self.contents(self.alone))
            shutil.rmtree(self.output)


if __name__ == "__main__":
    unittest.main()
