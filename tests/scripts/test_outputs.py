"""Tests of the one rule for outputs of all tools: nothing that is read is written, links are kept,
devices stay, an old file stays if the new one cannot be written, and signals leave nothing behind."""

import contextlib
import ctypes
import gzip
import json
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import time
import unittest

from support import (DATA, PROGRAM, SCRIPTS, TestCase, can_draw, can_import, command, run, write_map,
                     write_program)

OVERWRITTEN = "and would be overwritten; choose another name"


class Outputs(TestCase):
    def setUp(self):
        super().setUp()
        self.atoms = pathlib.Path(shutil.copy(DATA / "c60.xyzr", self.folder))
        self.mesh, self.table = self.folder / "m.ply", self.folder / "t.csv"
        self.charged = self.folder / "ion.pqr"
        self.charged.write_text("ATOM 1 C ION 1 0 0 0 1.00 2.00\n")
        self.run_program(self.atoms, "-q", "--write", "none", "--mesh", self.mesh, "--spacing", "0.8")
        self.atom_table = self.folder / "c60.atoms.csv"
        self.run_program("measure", self.atoms, "-q", "--csv", self.table, "--write", "atoms", "-o", self.folder)
        self.potential = write_map(self.folder / "x.dx", 5)

    def run_program(self, *arguments):
        self.assertDone(subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False))

    def writers(self):
        """Yields tool, arguments, the option of the output, and an input, which exists."""
        yield "assemble", ["--copies", 1, "--rings", 1, self.atoms, "--program", PROGRAM], "-o", self.atoms
        yield "report", [self.table], "-o", self.table
        if shutil.which("apbs"):
            yield ("apbs", [self.charged, "--program", PROGRAM, "--spacing", 1], "--write-potential",
                   self.charged)
        if can_import(SCRIPTS / "view", "numpy"):
            yield "view", [self.atoms, "--program", PROGRAM], "-o", self.atoms
            yield "view", [self.mesh, "--potential", self.potential], "-o", self.potential
            yield ("view", [self.atoms, "--table", self.atom_table, "--program", PROGRAM], "-o",
                   self.atom_table)
        if can_draw():
            yield "render", [self.mesh, "--size", 40], "-o", self.mesh
            yield "render", [self.mesh, "--potential", self.potential, "--size", 40], "-o", self.potential

    def name_for(self, tool, path):
        """Returns a name of an output that the tool accepts."""
        return path.with_suffix(".dx") if tool == "apbs" else path.with_suffix(".out")

    def test_files_named_after_the_dashes_are_inputs(self):
        radii = self.folder / "radii.html"
        radii.write_text("none")
        for tool, arguments in (("view", [self.atoms, "-o", radii, "--", "--radii", radii]),
                                ("view", [self.atoms, "-o", radii, "--", f"--radii={radii}"]),
                                ("report", [self.table, "--pictures", "x", "-o", radii, "--", "--radii", radii])):
            with self.subTest(tool=tool):
                done = run(tool, *arguments)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(OVERWRITTEN, done.stderr)
                self.assertEqual(radii.read_text(), "none")

    def test_pipes_are_not_opened_before_the_output(self):
        """A reader of a pipe would take the first closing as the end."""
        pipe = self.folder / "pipe.html"
        os.mkfifo(pipe)
        with subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE) as reader:
            self.assertDone(run("report", self.table, "-o", pipe))
            self.assertIn(b"</html>", reader.communicate(timeout=60)[0])

    def test_arguments_of_the_program_follow_dashes(self):
        done = run("report", self.table, "-o", self.folder / "a.html", "--chains", "A")
        self.assertDone(done, 2)
        self.assertIn("unrecognized arguments: --chains A; arguments of eses-blocks follow --", done.stderr)

    def test_inputs_are_not_overwritten(self):
        for tool, arguments, option, read in self.writers():
            before = read.read_bytes()
            hard, soft = (self.name_for(tool, self.folder / name) for name in ("hard", "soft"))
            os.link(read, hard)
            soft.symlink_to(read.name)
            for output in (hard, soft, *(() if tool == "apbs" else (read,))):
                with self.subTest(tool=tool, output=output.name):
                    done = run(tool, *arguments, option, output)
                    self.assertDone(done, 1)
                    self.assertIn(OVERWRITTEN, done.stderr)
                    self.assertEqual(read.read_bytes(), before)
            hard.unlink()
            soft.unlink()

    def test_standard_output_is_not_an_input(self):
        before = self.atoms.read_bytes()
        with open(self.atoms, "ab") as output:
            done = subprocess.run(command("assemble", self.atoms), stdout=output, stderr=subprocess.PIPE,
                                  text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn(OVERWRITTEN, done.stderr)
        self.assertEqual(self.atoms.read_bytes(), before)

    def test_links_devices_and_old_files_stay(self):
        for tool, arguments, option, _ in self.writers():
            old, link, full = (self.name_for(tool, self.folder / name) for name in ("old", "link", "full"))
            old.write_text("old")
            link.symlink_to(old.name)
            full.symlink_to("/dev/full")
            with self.subTest(tool=tool):
                done = run(tool, *arguments, option, full)
                self.assertDone(done, 1)
                self.assertIn(f"{full}: No space left on device", done.stderr)
                self.assertTrue(full.is_symlink() and full.is_char_device())
                self.assertDone(run(tool, *arguments, option, self.name_for(tool, self.folder / "no/x")), 1)
                self.assertDone(run(tool, *arguments, option, self.name_for(tool, self.folder / ("y" * 253))), 1)
                self.assertEqual(old.read_text(), "old")
                self.assertDone(run(tool, *arguments, option, link))
                self.assertTrue(link.is_symlink())
                self.assertGreater(old.stat().st_size, 100)
            for path in (old, link, full):
                path.unlink()

    def test_long_names_are_written(self):
        for tool, arguments, option, _ in self.writers():
            output = self.name_for(tool, self.folder / ("y" * 245))
            with self.subTest(tool=tool):
                self.assertDone(run(tool, *arguments, option, output))
                output.unlink()

    def test_kept_files_of_apbs_are_not_its_inputs(self):
        if not shutil.which("apbs"):
            self.skipTest("apbs is not installed")
        source = self.folder / "molecule1.pqr"
        self.charged.rename(source)
        kept = self.folder / "kept"
        kept.mkdir()
        os.link(source, kept / "apbs.in")
        for folder in (self.folder, kept):
            with self.subTest(folder=folder.name):
                done = run("apbs", source, "--program", PROGRAM, "--spacing", 1, "--keep", folder)
                self.assertDone(done, 1)
                self.assertIn(OVERWRITTEN, done.stderr)
        self.assertIn("ION", source.read_text())

    def test_pages_and_pictures_are_not_confused(self):
        for tool, source, name in (("report", self.table, "a.png"), ("render", self.mesh, "a.html"),
                                   ("traj", self.atoms, "a.html"),
                                   ("render", self.mesh, "a.jpg"), ("render", self.mesh, "a.txt")):
            done = run(tool, source, "-o", self.folder / name)
            self.assertDone(done, 2)
            self.assertIn("use a name that ends in", done.stderr)

    def test_numbers_of_render_are_checked(self):
        for option, value in (("--size", 100000000), ("--size", 0), ("--zoom", "nan"), ("--zoom", 0),
                              ("--zoom", 1e300), ("--azimuth", "inf"), ("--elevation", "nan"),
                              ("--apart", "inf")):
            done = run("render", self.mesh, "-o", self.folder / "a.png", option, value)
            self.assertDone(done, 2)
            self.assertIn(f"argument {option}: expected a", done.stderr)

    def test_damaged_files_are_named(self):
        packed = gzip.compress(self.table.read_bytes())
        for data in (packed[:-9], packed[:30] + b"####" + packed[34:], b"nothing"):
            (self.folder / "t.csv.gz").write_bytes(data)
            done = run("report", self.folder / "t.csv.gz", "-o", self.folder / "a.html")
            self.assertDone(done, 1)
            self.assertIn("t.csv.gz: the file is damaged", done.stderr)
            self.assertNotIn("Traceback", done.stderr)

    def test_pages_have_no_numbers_that_json_lacks(self):
        self.table.write_text("file,atoms,ses_area\na,10,nan\nb,inf,3\nc,-inf,Infinity\n")
        page = self.folder / "a.html"
        self.assertDone(run("report", self.table, "-o", page))
        for word in ("NaN", "Infinity"):
            self.assertNotIn(word, page.read_text().partition('id="rows">')[2].partition("</script>")[0])


class Program(TestCase):
    """The same rules for eses-blocks, and what it refuses before it computes."""

    def call(self, *arguments, code=0):
        done = subprocess.run([PROGRAM, *arguments], cwd=self.folder, capture_output=True, text=True,
                              check=False, timeout=300)
        self.assertDone(done, code)
        return done

    def reads_of_folder(self, folder, action):
        """Returns how often the entries of a folder are read, as inotify(7) counts it. Skips the test if the system does
        not count."""
        libc, access, is_folder = ctypes.CDLL(None), 0x1, 0x40000000
        descriptor = libc.inotify_init1(os.O_NONBLOCK)
        if descriptor < 0 or libc.inotify_add_watch(descriptor, os.fsencode(folder), access | 0x20 | 0x100) < 0:
            self.skipTest("inotify is missing")
        try:
            action()
            events = b""
            with contextlib.suppress(BlockingIOError):
                while True:
                    events += os.read(descriptor, 1 << 16)
        finally:
            os.close(descriptor)
        count = 0
        while events:
            _, mask, _, length = struct.unpack_from("iIII", events)
            self.assertFalse(mask & 0x4000, "too many events")
            count += mask & (access | is_folder) == (access | is_folder)
            events = events[16 + length:]
        return count

    def test_tables_of_many_files_do_not_read_the_folder_for_each(self):
        """The work would otherwise grow with the square of the number of files."""
        self.assertEqual(self.reads_of_folder(self.folder, lambda: os.listdir(self.folder)) > 0, True)
        counts = []
        for files in (40, 160):
            source, target = self.folder / f"in{files}", self.folder / f"out{files}"
            source.mkdir()
            target.mkdir()
            for k in range(files):
                (source / f"{k}.xyzr").write_text("0 0 0 1.5\n")
            counts.append(self.reads_of_folder(target, lambda source=source, target=target: self.call(
                "measure", source, "-q", "--write", "atoms,cavities", "-o", target, "-t", "1")))
            self.assertEqual(len(os.listdir(target)), 2 * files)
        self.assertEqual(counts[0], counts[1])
        self.assertLess(counts[0], 10)

    def test_msms_keeps_links(self):
        for name in ("x.vert", "x.face"):
            (self.folder / name).symlink_to(f"real.{name}")
        (self.folder / "x_1.vert").write_text("of an earlier run\n")
        for _ in range(2):
            self.call("msms", "-if", DATA / "c60.xyzr", "-of", "x")
            self.assertTrue((self.folder / "x.vert").is_symlink() and (self.folder / "x.face").is_symlink())
            self.assertGreater((self.folder / "real.x.vert").stat().st_size, 1000)
            self.assertFalse((self.folder / "x_1.vert").exists())

    def test_names_up_to_the_limit_of_the_system_are_written(self):
        name = "y" * 245
        self.call("measure", DATA / "c60.xyzr", "-q", "--csv", name + ".csv")
        self.call(DATA / "c60.xyzr", "-q", "--write", "none", "--mesh", name + ".ply")
        self.call("msms", "-if", DATA / "c60.xyzr", "-of", name)
        shutil.copy(DATA / "c60.xyzr", self.folder / ("y" * 240 + ".xyzr"))
        self.call("measure", "y" * 240 + ".xyzr", "-q", "--write", "atoms")
        for suffix in (".csv", ".ply", ".vert", ".face"):
            self.assertGreater((self.folder / (name + suffix)).stat().st_size, 100)
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name.startswith(".")], [])

    def test_hidden_files_of_long_names_are_removed_by_the_next_run(self):
        name = "y" * 245 + ".csv"
        stopped = subprocess.Popen([PROGRAM, "measure", "--csv", name, "-"], cwd=self.folder,
                                   stdin=subprocess.PIPE, stdout=subprocess.DEVNULL)
        end = time.monotonic() + 60
        while not list(self.folder.glob(".y*.part")) and time.monotonic() < end:
            time.sleep(0.01)
        stopped.kill()
        stopped.communicate()
        self.assertEqual(len(list(self.folder.glob(".y*.part"))), 1)
        self.call("measure", DATA / "c60.xyzr", "-q", "--csv", name)
        self.assertEqual(list(self.folder.glob(".y*")), [])

    def test_names_beyond_the_limit_are_refused_by_name(self):
        name = "y" * 255 + ".csv"
        done = self.call("measure", DATA / "c60.xyzr", "--csv", name, code=1)
        self.assertIn(f"cannot create ./{name}: File name too long", done.stderr)

    def test_far_atoms_are_named_and_refused(self):
        atoms = [f"{i} 0 0 1.7" for i in range(20)]
        far = self.folder / "far.xyzr"
        far.write_text("\n".join([*atoms, "2000 2000 2000 1.7", "3000 3000 -3000 1.7"]) + "\n")
        done = self.call(far, "--write", "none", "--dry-run", code=1)
        self.assertIn("2 atoms are far from the others and stretch the grid to", done.stderr)
        self.assertIn("lines 21, 22", done.stderr)
        self.assertIn("; remove atoms that do not belong to the molecule", done.stderr)
        self.assertIn("(--allow-far-atoms)", done.stderr)
        self.assertIn("; use a smaller margin", self.call(DATA / "c60.xyzr", "1.4", "0.4", "1e5", "--write", "none", code=1).stderr)
        done = self.call(far, "--write", "none", "--dry-run", "--allow-far-atoms")
        self.assertIn("warning: ", done.stderr)
        self.assertIn("lines 21, 22", done.stderr)
        found, = json.loads(self.call(far, "--write", "none", "--dry-run", "--allow-far-atoms", "--json").stdout)["diagnostics"]
        self.assertEqual([found[key] for key in ("kind", "severity", "count")], ["far_atoms", "warning", 2])
        self.assertEqual([(each["atom"], each["line"]) for each in found["first"]], [(20, 21), (21, 22)])
        self.call(far, "--write", "none", "--dry-run", "--region=0,0,0,9,9,9")
        far.write_text("\n".join([*atoms, "200 200 200 1.7"]) + "\n")  # 1e8 to 1e10 points
        done = self.call(far, "--write", "none", "--dry-run")
        self.assertIn("1 atom is far from the others and stretches the grid to", done.stderr)
        self.assertIn("line 21", done.stderr)
        self.assertEqual(self.call(DATA / "1ubq.xyzr", "--write", "none", "--dry-run").stderr, "")
        far.write_text("0 0 0 1.5\n500 0 0 1.5\n-300 600 300 1.5\n100 -400 200 1.5\n")  # no group has half of the atoms
        self.assertIn("the grid has 3.85e+09 points, of which at most",
                      self.call(far, "--write", "none", "--dry-run").stderr)

    def test_far_atoms_of_pockets_and_msms_are_named_and_refused(self):
        far = self.folder / "far.xyzr"
        near = "".join(f"{i} 0 0 1.7\n" for i in range(20))
        far.write_text(f"{near}900000 900000 900000 1.7\n")
        self.assertIn("line 21", self.call(far, "--write", "none", "--dry-run", code=1).stderr)
        for command in (["measure", far, "--pockets"], ["msms", "-if", far]):
            with self.subTest(command=command):
                done = self.call(*command, code=1)
                self.assertIn(f"{far}: 1 atom is far from the others and stretches the grid to", done.stderr)
                self.assertIn("line 21", done.stderr)
                self.assertIn("or allow far atoms (--allow-far-atoms)", done.stderr)
        far.write_text(near)
        for command in (["measure", far, "--pockets"], ["msms", "-if", far]):
            self.assertEqual(self.call(*command, "--allow-far-atoms").stderr, "")

    def test_diagnostics_of_json_have_all_warnings(self):
        """Each line of a warning is the message of an entry, whatever the command."""
        far = self.folder / "far.pdb"
        far.write_text("".join(
            f"ATOM  {i:5d}  CA  ALA A{i:4d}    {x:8.3f}{x:8.3f}{x:8.3f}  1.00  0.00           C\n"
            for i, x in enumerate([*range(0, 40, 2), 400], 1)))
        close = self.folder / "close.xyzr"
        close.write_text("0 0 0 1.7\n0.1 0 0 1.7\n9 0 0 1.7\n9 0 0 1.7\n18 0 0 1.7\n")
        tiny = self.folder / "tiny.xyzr"
        tiny.write_text("0.55 0.55 0.55 0.3\n")
        kinds = set()
        for command in ([far, "--write", "none", "--dry-run"], ["measure", far, "--pockets"], ["measure", far],
                        ["interface", far], [close, "--write", "none"], [close, "--write", "none", "0.5", "1.2"],
                        [tiny, "0.5", "1.1", "--write", "none"],
                        [close, "--write", "none", "--region=0,0,0,3,3,3", "1.4", "0.5"]):
            with self.subTest(command=command):
                done = self.call(*command, "--json")
                found = json.loads(done.stdout)["diagnostics"]
                printed = [line.partition("warning: ")[2] for line in done.stderr.splitlines()]
                self.assertEqual(sorted(each["message"] for each in found if each["severity"] == "warning"), sorted(printed))
                kinds.update(each["kind"] for each in found)
        self.assertLessEqual({"far_atoms", "one_atom_residue", "close", "duplicate", "swapped_lengths"}, kinds)
        found = json.loads(self.call("measure", far, "--pockets", "--json").stdout)["diagnostics"][-1]
        self.assertEqual((found["kind"], found["first"][0]["label"]), ("far_atoms", "A/ALA 21/CA"))

    def test_the_table_of_results_is_printed(self):
        self.call("measure", DATA / "c60.xyzr", DATA / "1ubq.xyzr", "--csv", self.folder / "t.csv")
        table = (self.folder / "t.csv").read_text()
        for files in ([DATA / "c60.xyzr"], [DATA / "c60.xyzr", DATA / "1ubq.xyzr"]):
            done = self.call("measure", *files, "--csv", "-")
            self.assertEqual(done.stdout.splitlines(), table.splitlines()[:len(files) + 1])
        self.assertEqual(os.listdir(self.folder), ["t.csv"])
        for more in (["--json"], ["--table", "atoms"]):
            self.assertIn("--csv - cannot be combined with", self.call("measure", DATA / "c60.xyzr", "--csv", "-", *more,
                                                                        code=2).stderr)
        done = self.call("measure", DATA / "c60.xyzr", "--write", "atoms", "-o", "-", code=2)
        self.assertIn("print one with --table", done.stderr)


@unittest.skipUnless(can_draw() and not os.environ.get("DISPLAY"), "needs python3-vtk9 and xvfb, no display")
class Signals(TestCase):
    def processes(self, scratch):
        """Returns the names of the processes that have this folder for temporary files."""
        names = []
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if f"TMPDIR={scratch}".encode() in (process / "environ").read_bytes().split(b"\0"):
                    names.append((process / "comm").read_text().strip())
            except OSError:
                pass  # it has ended, or belongs to another user
        return names

    def check(self, number, started, *arguments):
        """Sends the signal as soon as a program of this name runs."""
        scratch = self.folder / "scratch"
        scratch.mkdir(exist_ok=True)
        end = time.monotonic() + 100
        with subprocess.Popen(command(*arguments), env={**os.environ, "TMPDIR": str(scratch)},
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
            while (process.poll() is None and time.monotonic() < end
                   and started not in self.processes(scratch)):
                time.sleep(0.01)
            process.send_signal(number)
            _, errors = process.communicate(timeout=100)
        self.assertNotIn("Traceback", errors)
        self.assertEqual(process.returncode, 128 + number)
        self.assertEqual(list(scratch.iterdir()), [])
        self.assertEqual(self.processes(scratch), [])

    def test_signals_leave_nothing(self):
        mesh, table = self.folder / "m.ply", self.folder / "t.csv"
        for arguments in (("--mesh", mesh, "--write", "none", "--spacing", "0.3", DATA / "1ubq.xyzr"),
                          ("measure", "--csv", table, DATA / "1ubq.xyzr", DATA / "achbp.xyzr")):
            self.assertDone(subprocess.run([PROGRAM, "-q", *arguments] if arguments[0] != "measure" else
                                           [PROGRAM, *arguments, "-q"], capture_output=True, text=True,
                                           check=False))
        for number in (signal.SIGTERM, signal.SIGINT):
            with self.subTest(signal=number):
                self.check(number, "Xvfb", "render", mesh, "-o", self.folder / "a.png", "--size", 2000)
                self.check(number, "Xvfb", "report", table, "-o", self.folder / "a.html", "--pictures", "*",
                           "--program", PROGRAM)
        self.assertEqual([path.name for path in self.folder.iterdir() if "part" in path.name], [])

    def test_a_display_that_ends_is_a_message(self):
        """VTK aborts its process if the server does not answer, as one that has just ended."""
        mesh, scratch = self.folder / "m.off", self.folder / "scratch"
        mesh.write_text("OFF\n4 4 0\n0 0 0\n3 0 0\n0 3 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
        scratch.mkdir()
        bin_folder = self.folder / "bin"
        bin_folder.mkdir()
        write_program(bin_folder / "Xvfb", 'eval "echo 9999 >&$2"\nexec sleep 100\n')
        for more in ({"PATH": f"{bin_folder}:{os.environ['PATH']}"}, {"DISPLAY": ":9999"}):
            with self.subTest(more=more):
                done = run("render", mesh, "-o", self.folder / "a.png",
                           env={**os.environ, "TMPDIR": str(scratch), **more})
                picture = self.folder / "a.png"
                if done.returncode == 0:  # VTK 9.4 and later may draw without the display
                    self.assertTrue(picture.read_bytes().endswith(b"IEND\xaeB`\x82"))
                    picture.unlink()
                else:
                    self.assertEqual(done.returncode, 1, done.stderr)
                    self.assertRegex(done.stderr, r"^render: no picture: VTK ended with .* on the display :9999.*\n$")
                    self.assertFalse(picture.exists())
                self.assertEqual(list(scratch.iterdir()), [])
                self.assertEqual(self.processes(scratch), [])


if __name__ == "__main__":
    unittest.main()
