"""Tests of scripts/benchmarks/simulate: results that follow from arithmetic, and a measurement
up to the plot."""

import json
import os
import pathlib
import random
import subprocess
import unittest
import xml.etree.ElementTree

from support import (DATA, PROGRAM, PROJECT, SCRIPTS, TestCase, has_matplotlib, interpreter_of, run)

import costs
import scaling

SCRIPT = SCRIPTS / "benchmarks" / "simulate"
BLOCK_COSTS = pathlib.Path(os.environ.get("ESES_BLOCK_COSTS",
                                          PROJECT / "build" / "tests" / "print-block-costs"))

PLANES = 64
ONE_THREAD = scaling.Machine(threads=1)


def even_costs(plane_seconds=1.0, plane_atoms=0, columns=1, block_size=2, **values):
    """Returns costs in which all planes are equal and, unless given, only blocks cost time."""
    settings = {name: 0 for name in costs.NUMBERS}
    settings.update(dict.fromkeys(costs.WORDS, "none"))
    settings.update(spacing=1.0, nx=2 + (columns - 1) * (block_size - 1), ny=2, nz=PLANES,
                    atoms=plane_atoms * PLANES, **values)
    settings.update((f"block_n{axis}", block_size) for axis in "xyz")
    layers = [costs.Layer([[plane_seconds * planes / columns] * columns], [plane_atoms] * planes,
                          10 * planes) for planes in costs.layer_planes(settings)]
    return costs.Costs(settings, layers)


def efficiencies(model, ranks, machine=ONE_THREAD):
    one = model.run(1, machine)
    return [scaling.efficiency(model.run(n, machine), one) for n in ranks]


class Schedule(unittest.TestCase):
    def test_one_thread_never_waits(self):
        layers = [scaling.Layer([5], [1, 2], [3]), scaling.Layer([], [4], [5])]
        self.assertEqual(scaling.makespan(layers, 1, 0), 20)

    def test_longest_block_bounds_the_time(self):
        for blocks, took in (([3, 1, 1, 1], 3), ([1, 1, 1, 3], 4)):
            self.assertEqual(scaling.makespan([scaling.Layer([], blocks, [0])], 2, 8), took)

    def test_blocks_ahead_shorten_the_time(self):
        layers = [scaling.Layer([], [4, 1], [2]), scaling.Layer([], [1, 1], [0])]
        # With none ahead, the second layer begins when the first is written, at 6.
        self.assertEqual(scaling.makespan(layers, 2, 0), 7)
        self.assertEqual(scaling.makespan(layers, 2, 2), 6)

    def test_patches_come_first(self):
        # A block cannot begin before the patches of its layer are built.
        self.assertEqual(scaling.makespan([scaling.Layer([1, 3], [2], [0])], 2, 8), 5)
        # The patches of the second layer are built beside the slowest block of the first.
        layers = [scaling.Layer([], [4, 1], [0]), scaling.Layer([2, 1], [1], [0])]
        self.assertEqual(scaling.makespan(layers, 2, 2), 5)
        # If no block may be solved ahead, no patches are built ahead.
        self.assertEqual(scaling.makespan(layers, 2, 0), 7)

    def test_time_is_between_its_bounds(self):
        chance = random.Random(3)

        def numbers():
            return [chance.random() for _ in range(chance.randint(1, 9))]

        for _ in range(50):
            layers = [scaling.Layer(numbers(), numbers(), numbers())
                      for _ in range(chance.randint(1, 5))]
            work = sum(sum(map(sum, layer)) for layer in layers)
            for threads in (1, 2, 3, 16):
                took = scaling.makespan(layers, threads, 4 * threads)
                self.assertGreater(took, work / threads - 1e-9)
                self.assertLess(took, work + 1e-9)
                # The text of a layer follows its blocks and the text of the previous layer.
                chain = sum(max(layer.chunks) for layer in layers)
                chain += max(layers[0].patches) + max(layers[0].blocks)
                self.assertGreater(took, chain - 1e-9)


class Cuts(unittest.TestCase):
    def test_equal_sums_are_cut_evenly(self):
        self.assertEqual(scaling.cut_evenly([1] * 8, 4), [0, 2, 4, 6, 8])
        # The sums are 0, 10, 11, 12. The nearest to 4 is 0, the nearest to 8 is 10.
        self.assertEqual(scaling.cut_evenly([10, 1, 1], 3), [0, 0, 1, 3])
        self.assertEqual(scaling.cut_evenly([1], 3)[-1], 1)

    def test_layers_are_those_of_the_program(self):
        # A block of 64 points owns 63 planes, but the last plane of the grid belongs to the block
        # below it.
        self.assertEqual(scaling.layers_of(0, 64, 63, 64), [(0, 64)])
        self.assertEqual(scaling.layers_of(0, 64, 63, 65), [(0, 63), (63, 64)])
        self.assertEqual(scaling.layers_of(5, 6, 63, 100), [(5, 6)])
        self.assertEqual(scaling.layers_of(10, 140, 63, 200), [(10, 73), (73, 136), (136, 140)])


class Runs(TestCase):
    def test_equal_planes_scale_perfectly(self):
        """Without a halo nothing is lost until there are more processes than planes."""
        for block_size in (2, 17, 64):
            model = scaling.Model(even_costs(block_size=block_size))
            for one in efficiencies(model, (1, 2, 4, 8, 16, 32, 64)):
                self.assertAlmostEqual(one, 1)
            self.assertEqual(efficiencies(model, (128, 256)), [0.5, 0.25])
            self.assertAlmostEqual(model.run(64, ONE_THREAD).seconds, 1)

    def test_threads_share_blocks(self):
        model = scaling.Model(even_costs(columns=16, block_size=2))
        four = model.run(1, scaling.Machine(threads=4))
        self.assertAlmostEqual(four.seconds, PLANES / 4)
        # A single block cannot be shared.
        alone = scaling.Model(even_costs(block_size=64))
        self.assertAlmostEqual(alone.run(1, scaling.Machine(threads=4)).seconds, PLANES)

    def test_plane_below_is_solved_again(self):
        """A slab of n planes costs n and a half, and the plane below it one and a half."""
        side, overhead = 16, 0.5
        # thin_planes is the cost of one plane, relative to the mean plane of a whole block.
        values = {"thin_planes": (1 + overhead) * side / (side + overhead)}
        settings = even_costs(block_size=side + 1, **values)
        settings.values["nz"] = 65
        layers = [costs.Layer([[side + overhead]], [0] * side, 0) for _ in range(3)]
        layers.append(costs.Layer([[side + 1 + overhead]], [0] * (side + 1), 0))
        model = scaling.Model(costs.Costs(settings.values, layers))
        self.assertAlmostEqual(model.run(1, ONE_THREAD).seconds, 65 + 4 * overhead)
        seconds = model.run(65, ONE_THREAD).seconds
        self.assertAlmostEqual(seconds, (1 + overhead) + (1 + overhead))

    def test_one_process_takes_the_measured_time(self):
        values = {"input_bytes": 10**6, "text_bytes": 10**7, "area_bytes": 10**5,
                  "probe_radius": 1.4, "mean_radius": 1.5, "max_radius": 2, "read_seconds": 9,
                  "read_alone_seconds": 1, "molecule_seconds": 2, "plan_seconds": 0.25,
                  "clusters_seconds": 0.5, "patch_seconds": 3, "text_seconds": 4, "area_seconds": 5,
                  "copy_read_seconds": 7, "copy_write_seconds": 8,
                  "copy_kernel_seconds": 6}
        model = scaling.Model(even_costs(plane_atoms=100, **values))
        for machine in (ONE_THREAD, scaling.Machine(16, 1e6, 1e6, 1e-3)):
            one = model.run(1, machine)
            self.assertEqual(scaling.efficiency(one, one), 1)
            self.assertIsNone(scaling.limit(one, one))
            self.assertEqual(one.sent, 0)
        one = model.run(1, ONE_THREAD)
        # The time contains everything except copying texts, because one process writes them
        # directly.
        self.assertAlmostEqual(one.seconds, 1 + 2 + 0.25 + 0.5 + 3 + PLANES + 4 + 5)
        self.assertAlmostEqual(one.shares[0].cpu, one.seconds)

    def test_file_system_limits_the_time(self):
        values = {"input_bytes": 10**6, "text_bytes": 5 * 10**7, "area_bytes": 10**5,
                  "read_seconds": 0.01, "text_seconds": 4, "copy_write_seconds": 0.5}
        model = scaling.Model(even_costs(plane_seconds=0.01, **values))
        for ranks in (1, 2, 16, 64):
            free = model.run(ranks, ONE_THREAD)
            # One process writes its text once. Several processes write it, read it and write it
            # again.
            passes = 1 if ranks == 1 else 3
            total = 10**6 + passes * 5 * 10**7 + 10**5
            self.assertEqual(free.file_system_bytes, total)
            self.assertEqual(model.run(ranks, ONE_THREAD._replace(file_system=1e30)).seconds,
                             free.seconds)
            for speed in (1e6, 1e8, 1e10):
                limited = model.run(ranks, ONE_THREAD._replace(file_system=speed))
                self.assertGreaterEqual(limited.seconds, total / speed * (1 - 1e-12))
                self.assertGreaterEqual(limited.seconds, free.seconds)

    def test_halo_atoms_are_counted(self):
        """With radii of 1 and no probe, a slab needs atoms up to 1 + 4 + 1 angstrom away."""
        atoms = 100
        model = scaling.Model(even_costs(plane_atoms=atoms, mean_radius=1.0, max_radius=1.0))
        # There are four slabs of 16 planes. Those in the middle include the plane below and reach
        # from -1 - 6 to 16 + 6 planes. At the ends they begin at the first atom, half a plane below
        # the first plane.
        run_of_four = model.run(4, ONE_THREAD)
        halo = (2 * 22.5 + 2 * 29) * atoms
        areas = (2 * 17.5 + 2 * 19) * atoms  # 1 angstrom around each slab
        self.assertEqual([share.atoms for share in run_of_four.shares],
                         [22.5 * atoms, 29 * atoms, 29 * atoms, 22.5 * atoms])
        # An atom takes 48 bytes and an area 32. Three quarters of them go to other processes. Atoms
        # are sent once, because the cut by atoms is also the cut by time.
        sent = (48 * halo + 32 * areas) * 3 / 4 / 4
        few = run_of_four.sent - sent
        self.assertGreater(few, 0)
        self.assertLess(few, 1000 * 3 + 100 * PLANES)  # a few numbers for each process and plane
        totals = [ranks * model.run(ranks, ONE_THREAD).sent for ranks in (1, 2, 4, 8, 16, 32, 64)]
        self.assertEqual(totals, sorted(set(totals)))

    def test_slabs_are_cut_again_if_it_gains(self):
        """The slabs are cut again only if this gains more than preparing the atoms again costs."""
        settings = even_costs(plane_atoms=1000)
        # The lines are the crossings of each plane of the lower half, the cut by time, and the
        # expected cut.
        for crossings, evenly, made in ((0, 32, 32), (3000, 31, 32), (6000, 29, 29)):
            layers = [layer._replace(crossings=crossings if bz < PLANES / 2 else 0)
                      for bz, layer in enumerate(settings.layers)]
            model = scaling.Model(costs.Costs(settings.values, layers))
            with self.subTest(crossings):
                cuts = scaling.cut_evenly(model.estimated_costs(), 2)
                self.assertEqual(cuts, [0, evenly, PLANES])
                below, above = model.slabs(2)
                self.assertEqual((below.end, above.begin), (made, made))
                # Atoms are also sent for the first slabs.
                self.assertEqual([slab.first_atoms > 0 for slab in (below, above)],
                                 [made != PLANES / 2] * 2)

    def test_threads_share_the_preparation_of_atoms(self):
        """One thread makes the cell list. The rest is shared evenly."""
        by_one = scaling.MOLECULE_BY_ONE
        model = scaling.Model(even_costs(plane_atoms=500, mean_radius=1, molecule_seconds=100,
                                         plan_seconds=7, clusters_seconds=3))
        for threads in (1, 2, 3, 16, 100):
            with self.subTest(threads):
                took = model.run(1, scaling.Machine(threads)).phases[scaling.PREPARE]
                # One thread makes the plan and sorts atoms into clusters.
                self.assertAlmostEqual(took, 7 + 3 + 100 * (by_one + (1 - by_one) / threads))

    def test_exchange_of_atoms_takes_time(self):
        """One thread finds the slabs of atoms, sends them, and stores those that it receives."""
        model = scaling.Model(even_costs(plane_atoms=1000))
        # The slab has half the planes and an angstrom more. The upper slab includes the plane below
        # it.
        come = 1000 * (PLANES / 2 + 1.5)
        seconds = (scaling.SECONDS_PER_HALVING * 1000 * PLANES / 2
                   + (scaling.SECONDS_PER_SENT_ATOM + scaling.SECONDS_PER_RECEIVED_ATOM) * come)
        for threads in (1, 16):
            phases = model.run(2, scaling.Machine(threads)).phases
            self.assertAlmostEqual(phases[scaling.EXCHANGE], seconds, places=12)
        self.assertEqual(model.run(1, ONE_THREAD).phases[scaling.EXCHANGE], 0)

    def test_texts_are_copied_by_two_threads(self):
        """If all processes share a machine, the kernel copies texts instead."""
        model = scaling.Model(even_costs(text_bytes=10**6, copy_read_seconds=4,
                                         copy_write_seconds=6, copy_kernel_seconds=5,
                                         area_seconds=1))
        areas = scaling.AREA_TEXTS / 2
        for threads, is_local, seconds in ((1, False, 10), (2, False, 6), (16, False, 6),
                                           (1, True, 5), (16, True, 5)):
            machine = scaling.Machine(threads, is_local=is_local)
            phases = model.run(2, machine).phases
            self.assertAlmostEqual(phases[scaling.MERGE], seconds / 2 + areas)
        self.assertAlmostEqual(model.run(1, ONE_THREAD).phases[scaling.MERGE], 1)

    def test_patches_of_the_halo_are_built(self):
        """With radii of 1 and no probe, a slab needs patches up to 1 + 2 angstrom away."""
        model = scaling.Model(even_costs(plane_seconds=0.0, plane_atoms=1000, patch_seconds=64.0,
                                         mean_radius=1.0, max_radius=1.0))
        for threads in (1, 4):
            phases = model.run(4, scaling.Machine(threads)).phases
            self.assertAlmostEqual(phases[scaling.SWEEP], (16 + 1 + 2 * 3) / threads, places=2)

    def test_network_takes_time(self):
        model = scaling.Model(even_costs(plane_atoms=100, mean_radius=1.0, max_radius=1.0))
        fast = model.run(4, ONE_THREAD)
        slow = model.run(4, ONE_THREAD._replace(network=1e3))
        # The largest slab gets 29 planes of atoms, three quarters of them from other processes.
        self.assertAlmostEqual(slow.phases[scaling.EXCHANGE] - fast.phases[scaling.EXCHANGE],
                               48 * 2900 * 0.75 / 1e3)
        self.assertGreater(slow.seconds, fast.seconds)
        late = model.run(4, ONE_THREAD._replace(latency=1.0))
        self.assertGreater(late.seconds - fast.seconds, 3)  # each receives from three others

    def test_memory_decreases_with_more_processes(self):
        model = scaling.Model(even_costs(plane_atoms=10000, mean_radius=1.5, max_radius=2.0,
                                         probe_radius=1.4))
        memory = [model.run(ranks, ONE_THREAD).memory for ranks in (1, 2, 4, 8, 16, 32, 64)]
        self.assertEqual(memory[1:], sorted(memory[1:], reverse=True))

    def test_patches_around_a_layer_are_held(self):
        """Patches of all atoms are held in a grid of few planes, otherwise those around a layer."""
        few, many = (scaling.Model(even_costs(plane_atoms=100, block_size=9, mean_radius=radius,
                                              max_radius=radius))
                     for radius in (30.0, 1.0))
        (slab,) = few.slabs(1)
        self.assertEqual(few.patched_at_a_time(slab, 24, 32), few.atoms)
        (slab,) = many.slabs(1)
        below, above = 1 + scaling.CELL_HEIGHT, 1 + 2 + 2 * scaling.CELL_HEIGHT
        self.assertEqual(many.patched_at_a_time(slab, 24, 32), 100 * (8 + 1 + below + above))
        # Threads that solve blocks ahead need the patches of two layers.
        two = many.run(1, scaling.Machine(2)).memory
        one = many.run(1, ONE_THREAD).memory
        self.assertGreater(two - one, 100 * 8 * scaling.PATCH_MEMORY)

    def test_copies_multiply_the_work(self):
        settings = even_costs(plane_seconds=0.5)
        self.assertAlmostEqual(scaling.Model(settings, 3).run(3, ONE_THREAD).seconds,
                               scaling.Model(settings).run(1, ONE_THREAD).seconds)

    def test_limiting_step_is_named(self):
        for names, values in ((("sweep",), {}),
                              (("sweep", "preparing"),  # the latter takes samples of patches
                               {"plane_atoms": 10**5, "patch_seconds": 1e3, "mean_radius": 2.0,
                                "max_radius": 2.0, "probe_radius": 1.4}),
                              (("merging",), {"copy_write_seconds": 1e4, "text_bytes": 10**6})):
            model = scaling.Model(even_costs(plane_seconds=0.01, **values))
            one = model.run(1, ONE_THREAD)
            self.assertIn(scaling.limit(model.run(128, ONE_THREAD), one), names)


class Files(TestCase):
    def simulate(self, *arguments, code=0):
        done = run("benchmarks/simulate", *arguments)
        self.assertDone(done, code)
        return done

    def saved(self, settings):
        path = self.folder / "costs.csv"
        costs.write(path, settings)
        return path

    def test_costs_are_read_as_written(self):
        settings = even_costs(plane_seconds=0.25, plane_atoms=7, columns=5, block_size=16,
                              structure="one, two", lower_z=-3.5)
        again = costs.read(self.saved(settings))
        self.assertEqual(again.values["structure"], "one, two")
        self.assertEqual(again.values["lower_z"], -3.5)
        self.assertEqual([layer.plane_atoms for layer in again.layers],
                         [layer.plane_atoms for layer in settings.layers])
        for one, other in zip(again.layers, settings.layers):
            for a, b in zip(one.seconds[0], other.seconds[0]):
                self.assertAlmostEqual(a, b, places=6)

    def test_bad_files_are_refused(self):
        text = self.saved(even_costs(plane_atoms=1)).read_text()
        lines = text.splitlines()

        def line_of(begin):
            return 1 + next(i for i, line in enumerate(lines) if line.startswith(begin))

        def changed(begin, new):
            return "\n".join(new if line.startswith(begin) else line for line in lines)

        for name, content, message in (
                ("word", changed("atoms,", "atoms,many"), f":{line_of('atoms,')}: expected a num"),
                ("nan", changed("spacing,", "spacing,nan"), f":{line_of('spacing,')}: expected"),
                ("minus", changed("read_seconds,", "read_seconds,-1"),
                 f":{line_of('read_seconds,')}: -1 is negative"),
                ("zero", changed("spacing,", "spacing,0"), ": spacing must be above 0"),
                ("twice", text + "atoms,5\n", f":{len(lines) + 1}: atoms a second time"),
                ("again", text + "blocks,0,0,1\n", f":{len(lines) + 1}: blocks of 0, 0 a second"),
                ("unknown", text + "colour,1\n", f":{len(lines) + 1}: no such value: 'colour'"),
                ("fields", text + "crossings,1\n", f":{len(lines) + 1}: crossings: expected 2"),
                ("lack", changed("nx,", ""), ": no value of nx"),
                ("hole", changed("blocks,3,0,", ""), ": no blocks of 3, 0"),
                ("short", changed("plane_atoms,3,", "plane_atoms,3,"), ": plane_atoms of 3: exp"),
                ("outside", text + "crossings,99,1\n", ": crossings of 99 is outside"),
                ("empty", "", ": no value of structure")):
            path = self.folder / f"{name}.csv"
            path.write_text(content)
            with self.subTest(name):
                done = self.simulate("run", path, code=1)
                self.assertIn(f"{name}.csv{message}", done.stderr)
                self.assertEqual((done.stdout, done.stderr.count("\n")), ("", 1))
        self.assertIn("missing", self.simulate("run", self.folder / "missing", code=1).stderr)

    def test_tables_have_the_computed_values(self):
        path = self.saved(even_costs(text_bytes=10**9, input_bytes=10**6))
        one = ("run", path, "--threads", "1", "--latency", "0", "--ranks", "1,64,256")
        text = self.simulate(*one, "--file-system", "0.01").stdout
        free, limited = text.split("A file system of 0.01 GB/s")
        self.assertNotIn("the file system\n", free)
        self.assertIn("the file system\n", limited)
        # With 64 planes, 256 processes have an efficiency of at most a quarter.
        rows = [line.split() for line in free.splitlines() if line.endswith(("-", "once"))]
        self.assertEqual([row[0] for row in rows], ["1", "64", "256"])
        self.assertEqual([row[3] for row in rows], ["100", "100", "25"])
        self.assertIn("stops scaling at 256 processes, with an efficiency of 25 %", free)
        markdown = self.simulate(*one, "--markdown", "--phases").stdout
        for line in markdown.splitlines():
            if line.startswith("|"):
                self.assertTrue(line.endswith("|"))
        self.assertEqual(markdown.count("\n| 64 |"), 4)
        self.assertIn("scales up to 64", self.simulate(
            "run", path, "--threads", "1", "--latency", "0", "--ranks", "1,64").stdout)

    def test_check_compares_with_real_runs(self):
        path = self.saved(even_costs(plane_seconds=1.0))
        processes = [{"first_plane": 0, "planes": 40, "atoms": 3, "cpu_seconds": 66.0,
                      "waiting_seconds": 2.0, "peak_memory_bytes": 10**9},
                     {"first_plane": 40, "planes": 24, "atoms": 4, "cpu_seconds": 16.0,
                      "waiting_seconds": 0.0, "peak_memory_bytes": 10**9}]
        runs = self.folder / "runs.json"
        runs.write_text(json.dumps({"date": "", "machine": {}, "settings": {"spacing": 1.0},
                                    "runs": [{"ranks": 2, "processes": processes}]}))
        rows = [line.split() for line in self.simulate("check", path, runs).stdout.splitlines()]
        # Each is computed to take 32 seconds. Measured were 64 and 16, 40 on average.
        self.assertEqual([row[9] for row in rows[1:3]], ["0.50", "2.00"])
        self.assertEqual(rows[-1], ["2", "1.000", "1.600", "64", "80"])
        runs.write_text("{}")
        self.assertIn("runs.json", self.simulate("check", path, runs, code=1).stderr)

    def test_invalid_options_are_refused(self):
        path = self.saved(even_costs())
        for arguments in (("run", path, "--ranks", "0"), ("run", path, "--threads", "-1"),
                          ("run", path, "--file-system", "0"), ("run", path, "--latency", "-1"),
                          ("run", path, "--copies", "none"), ("guess",), ()):
            self.simulate(*arguments, code=2)
        self.simulate("measure", self.folder / "missing.xyzr", code=1)

    def test_saved_costs_and_runs_in_doc_are_read(self):
        text = self.simulate("run", "--ranks", "1,2,4").stdout
        self.assertEqual(text.count("100 %"), 2)
        self.assertIn("planes", self.simulate("check").stdout)

    @unittest.skipUnless(BLOCK_COSTS.exists(), "print-block-costs is not built")
    def test_costs_are_measured_and_used(self):
        common = ("--spacing", "0.8", "--program", PROGRAM, "--scratch", self.folder)
        path = self.folder / "c60.csv"
        self.simulate("measure", DATA / "c60.xyzr", *common, "--block-program", BLOCK_COSTS,
                      "-o", path)
        saved = costs.read(path)
        self.assertEqual(saved.values["atoms"], 60)
        self.assertEqual(sum(sum(layer.plane_atoms) for layer in saved.layers), 60)
        self.assertAlmostEqual(saved.values["mean_radius"], 1.7)
        for name in ("text_bytes", "area_bytes", "block_nx", "thin_planes"):
            self.assertGreater(saved.values[name], 0, name)
        self.assertEqual(saved.values["write"], "edges,areas")
        runs = self.folder / "runs.json"
        self.simulate("real", DATA / "c60.xyzr", *common, "--ranks", "1", "-o", runs)
        (real,) = json.loads(runs.read_text())["runs"]
        (process,) = real["processes"]
        self.assertEqual((process["planes"], process["atoms"]), (saved.values["nz"], 60))
        self.assertIn("1 of 1", self.simulate("check", path, runs).stdout)
        (self.folder / "fails").write_text("#!/bin/sh\necho broken >&2\nexit 1\n")
        (self.folder / "fails").chmod(0o755)
        done = self.simulate("measure", DATA / "c60.xyzr", *common, "--block-program",
                             self.folder / "fails", "-o", self.folder / "x.csv", code=1)
        self.assertIn("broken", done.stderr)
        self.assertFalse((self.folder / "x.csv").exists())

    @unittest.skipUnless(has_matplotlib(SCRIPT), "python3-matplotlib is not installed")
    def test_result_is_plotted(self):
        path, figure = self.saved(even_costs(structure="evenly")), self.folder / "figure.svg"
        command = [interpreter_of(SCRIPT), SCRIPT, "plot", path, "--ranks", "1,2,4", "-o", figure]
        self.assertDone(subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True,
                                       text=True, check=False))
        words = figure.read_text(encoding="utf-8")
        xml.etree.ElementTree.fromstring(words)
        for word in ("evenly", "efficiency (%)", "10 GB/s for all processes", "ideal"):
            self.assertIn(word, words)
