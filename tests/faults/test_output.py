"""Tests of full disks, vanishing directories, closed streams and killed runs."""

import errno
import os
import resource
import shutil
import signal
import subprocess
import unittest

from faults import (NAMES, NO_SPACE, PROGRAM, SMALL, TINY, FaultTest, forget_signals, has_ended,
                    let_work, message_of, needs_gnu_openmp, needs_library, wait_for)

NOBODY = 65534


class FullDisk(FaultTest):
    @needs_library
    def test_full_disk_at_any_byte_leaves_no_file(self):
        reference = self.make_reference(*TINY)
        for name, content in reference.items():
            for byte in (1, len(content) // 2, len(content)):
                with self.subTest(name=name, byte=byte):
                    done = self.run_program(*TINY, fault=f"space {byte} .{name}.")
                    self.assertTrue(self.is_faulty())
                    self.assertFailed(done, f"cannot write {self.output / name}: {NO_SPACE}")
                    self.assertEqual(self.all_files(), [])
            self.run_program(*TINY, fault=f"space {len(content) + 1} .{name}.")
            self.assertFalse(self.is_faulty())  # the byte above was the last one
            self.assertEqual(self.contents(), reference)
            self.put({})

    @needs_library
    def test_older_files_survive_a_full_disk(self):
        older = {name: b"older" for name in NAMES}
        self.output.mkdir()
        for name in NAMES:
            self.put(older)
            self.run_program(*TINY, fault=f"space 1 .{name}.")
            self.assertTrue(self.is_faulty())
            self.assertEqual(self.contents(), older)

    @unittest.skipIf(os.environ.get("ESES_SANITIZE") == "thread",
                     "the sanitizer itself maps files that are larger")
    @needs_gnu_openmp
    def test_limit_on_the_size_of_files_is_an_error(self):
        def limit():
            forget_signals()
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
        done = self.run_program(SMALL, "-q", prepare=limit)
        self.assertFailed(done, message_of(errno.EFBIG))
        self.assertEqual(self.all_files(), [])

    def test_full_file_system_is_an_error(self):
        mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "none", self.output]
        self.output.mkdir()
        if os.geteuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode:
            self.skipTest("no file system can be mounted here")
        self.addCleanup(subprocess.run, ["umount", self.output], check=True)
        done = self.run_program(SMALL, "1.4", "0.2", "--write", "edges", "-q")
        self.assertFailed(done, NO_SPACE)
        self.assertEqual(self.all_files(), [])


@needs_library
class EveryCall(FaultTest):
    """Makes each call that opens, locks, writes, closes, renames or removes a file fail in turn."""

    def for_every_call(self, action, check):
        for number in range(1, 1000):
            done = self.run_program(*TINY, fault=f"file {number} {action}")
            if not self.is_faulty():
                self.assertGreater(number, 20)
                self.assertDone(done)
                return
            with self.subTest(call=number):
                check(done)
        self.fail("there is no end of calls")

    def test_failure_of_any_call_leaves_no_file(self):
        reference = self.make_reference(*TINY)

        def check(done):
            if done.returncode == 0:  # locks may fail, and may stay
                self.assertEqual({name: content for name, content in self.contents().items()
                                  if name in NAMES}, reference)
            else:
                self.assertFailed(done, message_of(errno.EIO))
                self.assertEqual([name for name in self.all_files() if name in NAMES], [])
            self.put({})
        self.for_every_call(f"fail={errno.EIO}", check)

    def test_kill_at_any_call_leaves_files_of_one_run(self):
        """Files under their final names are from one run. The next run removes the other files."""
        reference = self.make_reference(*TINY)
        older = {name: b"older" for name in NAMES}
        self.put(older)
        states = set()

        def check(done):
            self.assertEqual(done.returncode, -signal.SIGKILL)
            found = {name: content for name, content in self.contents().items() if name in NAMES}
            run = older if b"older" in found.values() else reference
            self.assertLessEqual(found.items(), run.items())
            if "bounding_box.txt" in found:
                self.assertEqual(found, run)
            states.add((len(found), run is older))
            self.assertDone(self.run_program(*TINY))
            self.assertEqual(self.contents(), reference)
            self.put(older)
        self.for_every_call(f"signal={signal.SIGKILL.value}", check)
        self.assertLessEqual({(4, True), (3, True), (1, False), (4, False)}, states)


@needs_library
class Mesh(FaultTest):
    """A mesh in a directory of its own."""

    def setUp(self):
        super().setUp()
        self.meshes = self.folder / "meshes"
        self.arguments = (*TINY, "--mesh", self.meshes / "a.ply")

    def assertNothing(self):
        final = [name for name in self.all_files() if name in NAMES]
        self.assertEqual((final, [name for name in self.all_files(self.meshes) if name == "a.ply"]),
                         ([], []))

    def make_mesh(self):
        self.assertDone(self.run_program(*self.arguments))
        self.assertEqual(self.all_files(self.meshes), ["a.ply"])
        return (self.meshes / "a.ply").read_bytes()

    def test_full_disk_keeps_the_older_mesh(self):
        mesh = self.make_mesh()
        older = self.contents()
        for byte in (1, len(mesh) // 2, len(mesh)):
            with self.subTest(byte=byte):
                done = self.run_program(*self.arguments, fault=f"space {byte} .a.ply.")
                self.assertTrue(self.is_faulty())
                self.assertFailed(done, f"cannot write {self.meshes / 'a.ply'}: {NO_SPACE}")
                self.assertEqual(self.contents(), older)
                self.assertEqual(self.contents(self.meshes), {"a.ply": mesh})

    def for_every_call(self, action, check):
        for number in range(1, 1000):
            for folder in (self.output, self.meshes):
                shutil.rmtree(folder, ignore_errors=True)
            done = self.run_program(*self.arguments, fault=f"file {number} {action}")
            if not self.is_faulty():
                self.assertGreater(number, 30)
                return
            with self.subTest(call=number):
                check(done)
        self.fail("there is no end of calls")

    def test_failure_of_any_call_leaves_no_files(self):
        mesh = self.make_mesh()

        def check(done):
            if done.returncode == 0:  # locks may fail, and may stay
                self.assertEqual((self.meshes / "a.ply").read_bytes(), mesh)
            else:
                self.assertFailed(done, message_of(errno.EIO))
                self.assertNothing()
        self.for_every_call(f"fail={errno.EIO}", check)

    def test_signal_at_any_call_leaves_all_files_or_none(self):
        def check(done):
            self.assertIn(done.returncode, (0, 128 + signal.SIGTERM.value), done)
            left = self.all_files() + self.all_files(self.meshes)
            complete = [*sorted(NAMES), "a.ply"]  # only the locks remain to be removed
            self.assertIn(left, ([], complete) if done.returncode else (complete,))
        self.for_every_call(f"signal={signal.SIGTERM.value}", check)

    def other_run(self, *arguments):
        return subprocess.run([PROGRAM, SMALL, "-q", "--write", "none", *map(str, arguments)],
                              capture_output=True, text=True, check=False)

    def test_one_run_writes_a_mesh_at_a_time(self):
        """A second run for the same mesh is refused; other meshes may be written, also into the
        output directory."""
        program = self.stop_at("write 2", *self.arguments)
        link = self.folder / "link.ply"
        link.symlink_to(self.meshes / "a.ply")
        for path in (self.meshes / "a.ply", link):
            self.assertFailed(self.other_run("--mesh", path), f"cannot write {self.meshes / 'a.ply'}"
                              ": another run is writing it")
        unfinished = self.all_files(self.meshes)
        for folder in (self.meshes, self.output):
            self.assertDone(self.other_run("--mesh", folder / "b.off"))
        self.assertEqual(self.all_files(self.meshes), sorted([*unfinished, "b.off"]))
        program.send_signal(signal.SIGCONT)
        self.assertDone(self.finish(program))
        self.assertEqual(self.all_files(self.meshes), ["a.ply", "b.off"])
        self.assertEqual(self.all_files(), sorted([*NAMES, "b.off"]))

    def test_link_into_a_missing_directory_is_refused(self):
        """The mesh is refused and the directory is not created. Without a link it would be
        created."""
        missing = self.folder / "unmounted"
        link = self.folder / "link.ply"
        link.symlink_to(missing / "a.ply")
        chain = self.folder / "chain.ply"
        chain.symlink_to(link)
        for path in (link, chain):
            for more in ((), ("--dry-run",), ("--resume", "-o", self.output)):
                self.assertFailed(self.other_run("--mesh", path, *more),
                                  f"cannot write {path}: it is a symbolic link into {missing}, "
                                  "which does not exist")
        self.assertFalse(missing.exists())
        self.assertEqual(self.all_files(), [])
        self.assertDone(self.other_run("--mesh", missing / "b.ply"))
        self.assertDone(self.other_run("--mesh", link))
        self.assertEqual(self.all_files(missing), ["a.ply", "b.ply"])
        self.assertTrue(link.is_symlink())

    def test_runs_may_share_the_directory_of_a_mesh(self):
        """The directory may receive the files of another run, which leaves the unfinished mesh
        alone."""
        program = self.stop_at("write 2", SMALL, "-q", "--write", "none", "--mesh",
                               self.output / "a.ply")
        self.assertDone(subprocess.run([PROGRAM, *TINY, "-o", self.output], capture_output=True,
                                       text=True, check=False))
        program.send_signal(signal.SIGCONT)
        self.assertDone(self.finish(program))
        self.assertEqual(self.all_files(), sorted([*NAMES, "a.ply"]))

    def test_next_run_removes_files_of_a_killed_run(self):
        """The next run for the same mesh removes the files of a killed run; other runs leave
        them."""
        program = self.stop_at("write 2", *self.arguments)
        program.kill()
        self.finish(program)
        left = self.all_files(self.meshes)
        self.assertEqual(len(left), 2, left)
        self.assertDone(self.other_run("--mesh", self.meshes / "b.off"))
        self.assertEqual(self.all_files(self.meshes), sorted([*left, "b.off"]))
        self.assertDone(self.run_program(*self.arguments))
        self.assertEqual(self.all_files(self.meshes), ["a.ply", "b.off"])


@needs_library
class MeshOfTwoFiles(FaultTest):
    """Both files appear together or not at all."""

    MESH = ["a.face", "a.vert"]

    def setUp(self):
        super().setUp()
        self.meshes = self.folder / "meshes"
        self.arguments = (*TINY, "--write", "none", "--mesh", self.meshes / "a.face")

    def assertMesh(self, names):
        self.assertEqual([name for name in self.all_files(self.meshes) if name in self.MESH], names)

    def test_failure_of_any_call_leaves_both_files_or_none(self):
        self.assertDone(self.run_program(*self.arguments))
        reference = self.contents(self.meshes)
        self.assertEqual(sorted(reference), self.MESH)
        for action in (f"fail={errno.EIO}", f"signal={signal.SIGTERM.value}"):
            for number in range(1, 1000):
                shutil.rmtree(self.meshes, ignore_errors=True)
                done = self.run_program(*self.arguments, fault=f"file {number} {action}")
                if not self.is_faulty():
                    self.assertGreater(number, 10)
                    break
                with self.subTest(action=action, call=number):
                    if done.returncode == 0 or self.all_files(self.meshes) == self.MESH:
                        self.assertLessEqual(reference.items(),
                                             self.contents(self.meshes).items())
                    else:
                        self.assertMesh([])

    def test_full_disk_keeps_the_older_pair(self):
        self.assertDone(self.run_program(*self.arguments))
        older = self.contents(self.meshes)
        for name in self.MESH:
            for byte in (1, len(older[name])):
                with self.subTest(name=name, byte=byte):
                    done = self.run_program(*self.arguments, fault=f"space {byte} .{name}.")
                    self.assertTrue(self.is_faulty())
                    self.assertFailed(done, f"cannot write {self.meshes / name}: {NO_SPACE}")
                    self.assertEqual(self.contents(self.meshes), older)

    def test_one_run_writes_a_mesh_at_a_time(self):
        program = self.stop_at("write 2", *self.arguments)
        for name in self.MESH:
            done = subprocess.run([PROGRAM, SMALL, "-q", "--write", "none", "--mesh",
                                   self.meshes / name], capture_output=True, text=True, check=False)
            self.assertFailed(done, ": another run is writing it")
        program.send_signal(signal.SIGCONT)
        self.assertDone(self.finish(program))
        self.assertEqual(self.all_files(self.meshes), self.MESH)


@needs_library
class MapsAndCompressedFiles(FaultTest):
    """Further steps of a run with a map and compressed files."""

    ARGUMENTS = (*TINY, "--gzip", "--inside", "map.dx")
    FILES = sorted([*(name + ".gz" for name in NAMES), "map.dx"])

    def test_failure_of_any_call_leaves_no_files(self):
        self.assertDone(self.run_program(*self.ARGUMENTS))
        reference = self.contents()
        self.assertEqual(sorted(reference), self.FILES)
        self.put({})
        met = set()
        for call in ("rename", "close", "open"):
            for number in range(1, 100):
                done = self.run_program(*self.ARGUMENTS, fault=f"{call} {number} fail={errno.EIO}")
                if not self.is_faulty():
                    self.put({})
                    break
                met.add(call)
                with self.subTest(call=call, number=number):
                    if done.returncode == 0:  # closing the lock's file has failed
                        self.assertEqual(self.contents(), reference)
                    else:
                        self.assertFailed(done, message_of(errno.EIO))
                        self.assertEqual([name for name in self.all_files()
                                          if name in self.FILES], [])
                self.put({})
        self.assertEqual(met, {"rename", "close", "open"})

    def test_full_disk_while_the_map_is_made_leaves_no_file(self):
        self.assertDone(self.run_program(*self.ARGUMENTS))
        size = len(self.contents()["map.dx"])
        self.put({})
        for byte in (1, size // 2, size - 1):
            with self.subTest(byte=byte):
                done = self.run_program(*self.ARGUMENTS, fault=f"space {byte} .map.dx.")
                self.assertTrue(self.is_faulty())
                self.assertFailed(done, f"cannot write {self.output / 'map.dx'}: {NO_SPACE}")
                self.assertEqual(self.all_files(), [])

    def test_plain_files_survive_until_the_end(self):
        older = {name: b"older" for name in NAMES}
        self.output.mkdir()
        self.put(older)
        self.run_program(*self.ARGUMENTS, fault="space 1 .map.dx.")
        self.assertTrue(self.is_faulty())
        self.assertEqual(self.contents(), older)
        self.assertDone(self.run_program(*self.ARGUMENTS))
        self.assertEqual(self.all_files(), self.FILES)


class Directory(FaultTest):
    def test_file_in_place_of_the_directory_is_refused(self):
        self.output.write_text("no directory")
        self.assertFailed(self.run_program(SMALL, "-q"), str(self.output))
        self.assertEqual(self.output.read_text(), "no directory")

    def test_directory_in_place_of_a_file_is_refused(self):
        (self.output / "grid_info.txt").mkdir(parents=True)
        self.assertFailed(self.run_program(SMALL, "-q"), "it is a directory, not a regular file")
        self.assertEqual(self.all_files(), ["grid_info.txt"])

    def as_nobody(self):
        """Returns a function that drops the rights of the super-user, who may write anywhere."""
        if os.geteuid() != 0:
            return forget_signals

        def prepare():
            forget_signals()
            os.setuid(NOBODY)
        self.folder.chmod(0o755)
        try:
            subprocess.run([PROGRAM, "--version"], preexec_fn=prepare, check=True,
                           capture_output=True)
            subprocess.run(["cat", SMALL], preexec_fn=prepare, check=True, capture_output=True)
        except (OSError, subprocess.SubprocessError):
            self.skipTest("other users than root cannot reach the program")
        return prepare

    def test_read_only_directory_is_refused(self):
        nobody = self.as_nobody()
        self.output.mkdir()
        self.output.chmod(0o555)
        done = self.run_program(SMALL, "-q", prepare=nobody)
        self.assertFailed(done, f"cannot write into {self.output}: {message_of(errno.EACCES)}")
        self.assertEqual(self.all_files(), [])

    @needs_library
    def test_directory_that_becomes_read_only_is_an_error(self):
        nobody = self.as_nobody()
        self.output.mkdir()
        self.output.chmod(0o777)
        self.folder.chmod(0o777)
        program = self.stop_at("write 2", *TINY, prepare=nobody)
        self.output.chmod(0o555)
        program.send_signal(signal.SIGCONT)
        self.assertFailed(self.finish(program), message_of(errno.EACCES))
        self.assertEqual([name for name in self.all_files() if name in NAMES], [])
        self.output.chmod(0o777)
        self.assertDone(self.run_program(*TINY, prepare=nobody))  # removes the rest
        self.assertEqual(self.all_files(), sorted(NAMES))

    @needs_library
    def test_directory_that_vanishes_is_an_error(self):
        program = self.stop_at("write 2", *TINY)
        shutil.rmtree(self.output)
        program.send_signal(signal.SIGCONT)
        self.assertFailed(self.finish(program), str(self.output))
        self.assertFalse(self.output.exists())

    @needs_library
    def test_directory_that_vanishes_before_the_first_file_is_an_error(self):
        program = self.stop_at("open 1", *TINY)
        shutil.rmtree(self.output)
        program.send_signal(signal.SIGCONT)
        self.assertFailed(self.finish(program), str(self.output))

    @needs_library
    def test_renamed_directory_receives_the_files(self):
        reference = self.make_reference(*TINY)
        program = self.stop_at("write 2", *TINY)
        self.output.rename(self.folder / "moved")
        self.output.mkdir()
        program.send_signal(signal.SIGCONT)
        self.assertDone(self.finish(program))
        self.assertEqual(self.contents(self.folder / "moved"), reference)
        self.assertEqual(self.all_files(), [])


class Streams(FaultTest):
    def run_closed(self, *arguments):
        def prepare():
            forget_signals()
            os.close(1)
        return self.run_program(*arguments, prepare=prepare, stdout=None)

    def test_closed_standard_output_is_an_error(self):
        for more in ([], ["-q"], ["--json"]):
            done = self.run_closed(SMALL, *more)
            self.assertEqual(done.returncode, 1)
            self.assertIn("cannot write to standard output", done.stderr)
            self.assertEqual(self.all_files(), [])  # found before the run

    def test_full_standard_output_is_an_error(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        for more, files in (([], []), (["-q"], sorted(NAMES)), (["--json"], sorted(NAMES))):
            with open("/dev/full", "wb") as full:
                done = self.run_program(SMALL, *more, stdout=full)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"cannot write to standard output: {NO_SPACE}", done.stderr)
            self.assertEqual(self.all_files(), files)  # complete if found after the run

    def test_closed_pipe_is_an_error(self):
        reader, writer = os.pipe()
        os.close(reader)
        with os.fdopen(writer, "wb") as pipe:
            done = self.run_program(SMALL, stdout=pipe)
        self.assertEqual(done.returncode, 1)
        self.assertIn(message_of(errno.EPIPE), done.stderr)
        self.assertEqual(self.all_files(), [])


class TwoRuns(FaultTest):
    """A stopped run of many seconds replaces one that is running."""

    def long_run(self, *more):
        big = self.folder / "big.xyzr"
        big.write_text("0 0 0 200\n")
        program = self.start(big, "--spacing", "0.3", "--write", "edges", "-q", *more)
        wait_for(lambda: any(name.endswith(".part") and (self.output / name).stat().st_size > 0
                             for name in self.all_files()))
        program.send_signal(signal.SIGSTOP)
        return program

    def test_run_without_files_leaves_the_lock_alone(self):
        first = self.long_run()
        there = self.all_files()
        for _ in range(2):  # the second signal ends a run at once
            other = self.start(self.folder / "big.xyzr", "--spacing", "0.3", "--write", "none", "-q")
            let_work(other, 0.3)
            self.assertFalse(has_ended(other))
            other.send_signal(signal.SIGINT)
            other.send_signal(signal.SIGTERM)
            self.finish(other)
            self.assertEqual(self.all_files(), there)
        first.send_signal(signal.SIGCONT)
        first.kill()
        first.wait()

    def test_second_run_is_refused(self):
        first = self.long_run()
        there = self.all_files()
        for choice in ("edges", "grid", "areas", "grid,edges,areas"):
            done = self.run_program(SMALL, "-q", "--write", choice)
            self.assertFailed(
                done, f"cannot write into {self.output}: another run is writing there")
            self.assertEqual(self.all_files(), there)
        self.assertDone(self.run_program(SMALL, "-q", "--write", "none"))
        self.assertEqual(self.all_files(), there)
        first.kill()
        first.wait()
        self.assertEqual(self.all_files(), there)  # nothing has a final name
        self.assertDone(self.run_program(SMALL, "-q", "--write", "grid"))
        self.assertEqual(self.all_files(), ["bounding_box.txt", "grid_info.txt"])

    def test_second_run_by_another_name_is_refused(self):
        first = self.long_run()
        link = self.folder / "link"
        link.symlink_to(self.output)
        self.output = link
        self.assertFailed(self.run_program(SMALL, "-q"), "another run is writing there")
        first.kill()

    def test_many_runs_at_once_leave_complete_files(self):
        """Each run completes or is refused, and the files are complete."""
        reference = self.make_reference(*TINY)
        runs = [self.start(*TINY) for _ in range(12)]
        done = [self.finish(program) for program in runs]
        self.assertIn(0, [each.returncode for each in done])
        for each in done:
            if each.returncode != 0:
                self.assertFailed(each, "another run is writing there")
        self.assertEqual(self.contents(), reference)

    def test_other_hidden_files_stay(self):
        self.output.mkdir()
        others = [".grid_info.txt.part", ".grid_info.txt.x.part", ".other.txt.12.part", ".hidden"]
        for name in others:
            (self.output / name).touch()
        (self.output / ".grid_info.txt.12.part").touch()
        self.assertDone(self.run_program(SMALL, "-q"))
        self.assertEqual(self.all_files(), sorted([*others, *NAMES]))

    @needs_library
    def test_run_continues_without_locks(self):
        """Without locks, as on some network file systems, the run continues."""
        reference = self.make_reference(*TINY)
        for code in (errno.ENOLCK, errno.EOPNOTSUPP, errno.EBADF):
            self.assertDone(self.run_program(*TINY, fault=f"lock 1 fail={code}"))
            self.assertTrue(self.is_faulty())
            self.assertLessEqual(reference.items(), self.contents().items())
            self.put({})
