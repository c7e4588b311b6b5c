"""Computes the cost of a run with many processes from measured costs (see costs.py).

The steps are those of src/run and src/distributed. Atoms are read in equal parts and sent to
the slabs that need them, and sent again if the slabs are cut again. Each process then sweeps
its slab layer by layer: it builds patches, solves blocks and writes texts, in the order in which
src/run/task_queue.cpp hands these tasks out. Texts are copied from scratch files into the shared
files, and areas are added up. Every process waits for the slowest at the end of each step.
"""

import bisect
import collections
import heapq
import itertools
import math
import re

from common import PROJECT
import costs as measured

INFINITY = math.inf


def source_constant(path, name):
    """Returns the value of a constant in a file of src/: a number, a product with `mebibyte`, or a
    power of two such as `std::size_t{1} << 16`. The size of a struct, such as `sizeof(Atom)`, is
    that of a static_assert."""
    found = re.search(rf"\b{re.escape(name)} ==? ([^;,]+?)\)?[;,]",
                      (PROJECT / "src" / path).read_text("utf-8"))
    if not found:
        raise LookupError(f"src/{path} has no constant {name}")
    factors, _, shift = found[1].partition("<<")
    value = math.prod(2**20 if factor.strip() == "mebibyte"
                      else float(re.sub(r"[\w:]+\{(\w+)\}", r"\1", factor))
                      for factor in factors.split("*"))
    value *= 2**int(shift or 0)
    return int(value) if value.is_integer() else value


# Seconds from which the program estimates the cost of a plane.
ESTIMATE = {name: source_constant("run/slabs.cpp", f"seconds_per_{name}")
            for name in ("atom", "prepared_atom", "crossing", "crossing_text", "point",
                         "point_text")}
HALO_SLACK, REACH_SLACK = 1.0, 1e-3  # angstrom: slabs.cpp, src/surface/reach.hpp

SENT_ATOM = source_constant("run/slabs.cpp", "sizeof(SentAtom)")
CHUNK_INFO, AREA_SHARE = (source_constant("distributed/checkpoint.cpp", f"sizeof({name})")
                          for name in ("ChunkInfo", "AtomSum"))
BASE_MEMORY = source_constant("run/memory.cpp", "base_bytes")
THREAD_MEMORY = source_constant("run/memory.cpp", "bytes_per_thread")
MPI_MEMORY = 14 * 2**20  # src/distributed/processes_mpi.cpp
ATOM_MEMORY, CROSSING_MEMORY = 80, 48
PATCH_MEMORY = 340  # bytes of an atom's patches, as allocated for a ribosome
# Measured bytes of an atom while it is prepared. Several processes also keep the atoms that they
# have read, and their lines, until the slabs are final.
PREPARED_ATOM, READ_ATOM = 102, 40
CELL_HEIGHT = 3.0  # angstrom: src/surface/cell_list.hpp
MIN_SAMPLES, MAX_SAMPLES, ATOMS_PER_SAMPLE = (
    source_constant("surface/survey.cpp", name)
    for name in ("min_samples", "max_samples", "atoms_per_sample"))

# Numbers of calls in a run of several processes, as counted in one process. In an exchange each
# process sends something to each. Reductions and broadcasts go up and down a tree.
EXCHANGES, REDUCTIONS = 12, 67
# Share of the cell list, which one thread makes, in the time of preparing atoms with one thread
# (src/surface/molecule.cpp), from a profile.
MOLECULE_BY_ONE = 0.27
# Seconds of one thread in src/run/slabs.cpp: to halve the range of slabs once in the search
# for an atom's slab, to append a sent atom, and to append a received one.
SECONDS_PER_HALVING, SECONDS_PER_SENT_ATOM, SECONDS_PER_RECEIVED_ATOM = 1.2e-9, 60e-9, 25e-9
SECONDS_PER_ADDITION = 1.3e-9  # to add one area to the sum, in order: four cycles
AREA_TEXTS = 2  # each process makes its text twice: for the length, and to write it
BLOCKS_AHEAD = 4  # per thread: src/run/plan.cpp
# Number of equal tasks per thread into which the patches and the text of a layer are cut. The
# program cuts them into more tasks.
PARTS = 4

# file_system: bytes per second of all processes together. network: bytes per second of one process.
# latency: seconds of one message. is_local: all processes share a machine and its file system, so
# that the kernel copies texts.
Machine = collections.namedtuple("Machine", "threads file_system network latency is_local",
                                 defaults=(16, INFINITY, INFINITY, 0.0, False))

# The planes [begin, end) of a part of a layer. seconds: time of its blocks per plane, for each
# column. The program adds `overhead` planes to those of a block.
Segment = collections.namedtuple("Segment", "begin end seconds crossings")

# Planes [begin, end). first_atoms: atoms sent for the first slab, which is cut by atoms; 0 if it is
# final. atoms: atoms sent for the final slab. patched: atoms whose patches the slab needs.
# surveyed: atoms from which samples are taken, for each cut.
Slab = collections.namedtuple(
    "Slab", "begin end first_atoms atoms patched surveyed own_atoms crossings")
# The work of one process. cpu: seconds of all its threads.
Share = collections.namedtuple("Share", "begin end atoms patched cpu memory")

# phases: name -> seconds. sent: mean bytes sent by a process. memory: of the process with the most.
Run = collections.namedtuple("Run", "ranks seconds phases sent memory shares file_system_bytes")

READ, EXCHANGE, PREPARE, SWEEP, MERGE, AREAS = PHASES = (
    "reading", "exchange", "preparing", "sweep", "merging", "areas")

# The tasks of a layer of blocks, as seconds of each task.
Layer = collections.namedtuple("Layer", "patches blocks chunks")


def layers_of(begin, end, side, planes):
    """Returns the layers of blocks of a slab, as make_tiling cuts it."""
    count = end - begin + (end < planes)
    layers = (max(count, 2) - 2) // side + 1
    cuts = [begin + side * i for i in range(layers)] + [end]
    return list(zip(cuts, cuts[1:]))


def cut_evenly(numbers, parts):
    """Cuts as slabs.cpp does."""
    sums = [0, *itertools.accumulate(numbers)]
    begins = [0]
    for part in range(1, parts):
        wanted = sums[-1] * part / parts
        place = bisect.bisect_left(sums, wanted)
        if place and wanted - sums[place - 1] < sums[place] - wanted:
            place -= 1
        begins.append(max(begins[-1], place))
    return [*begins, len(numbers)]


def max_part(numbers, begins):
    sums = [0, *itertools.accumulate(numbers)]
    return max(sums[end] - sums[begin] for begin, end in zip(begins, begins[1:]))


def sample_size(atoms):
    return min(atoms, max(MIN_SAMPLES, min(atoms / ATOMS_PER_SAMPLE, MAX_SAMPLES)))


# ------------------------------------------------------------------------------------ one slab


def makespan(layers, threads, ahead):
    """Returns the time at which the last task of these layers is done.

    The text of a layer is written as soon as all its blocks are solved, before any other task.
    Otherwise threads solve blocks of that layer. If none is left, they solve up to `ahead` blocks
    of the next layer. The patches of a layer are built before its first block.
    """
    if threads == 1:
        return math.fsum(itertools.chain.from_iterable(itertools.chain.from_iterable(layers)))
    taken = [[0, 0, 0] for _ in layers]  # patches, blocks, chunks
    done = [[0, 0, 0] for _ in layers]
    patches, blocks, chunks = range(3)
    unwritten = unsolved = 0

    def is_done(layer, kind):
        return done[layer][kind] == len(layers[layer][kind])

    def take_from(layer, kind):
        index = taken[layer][kind]
        if index == len(layers[layer][kind]):
            return None
        taken[layer][kind] += 1
        return layers[layer][kind][index], kind, layer

    def take():
        nonlocal unsolved
        if unwritten == len(layers):
            return None
        if is_done(unwritten, blocks) and (task := take_from(unwritten, chunks)):
            return task
        if unsolved == len(layers) or unsolved > unwritten + 1:
            return None
        if unsolved > unwritten and taken[unsolved][blocks] >= ahead:
            return None
        if not is_done(unsolved, patches):
            return take_from(unsolved, patches)
        task = take_from(unsolved, blocks)
        if taken[unsolved][blocks] == len(layers[unsolved].blocks):
            unsolved += 1
        return task

    now, idle, running = 0.0, threads, []
    while unwritten < len(layers):
        while idle and (task := take()):
            heapq.heappush(running, (now + task[0], *task[1:]))
            idle -= 1
        now, kind, layer = heapq.heappop(running)
        idle += 1
        done[layer][kind] += 1
        if kind == chunks and is_done(layer, chunks):
            unwritten += 1
    return now


class Model:
    """One structure, or several copies of it one above the other."""

    def __init__(self, costs, copies=1):
        values = self.values = costs.values
        self.copies = copies
        self.side = int(values["block_nz"]) - 1
        # A block of n planes costs as much as n + overhead of its planes. This includes a block of
        # one plane, if thin_planes has been measured.
        thin = values["thin_planes"]
        if thin >= self.side > 1:
            thin = self.side - 0.5  # then the cost is in blocks, not in planes
        self.overhead = max(0.0, self.side * (thin - 1) / (self.side - thin)
                            if self.side > thin else 0.0)
        self.plane_below = 0.0 if thin == 0 else 1 + self.overhead
        self.segments = []
        self.plane_atoms = []
        for _ in range(copies):
            for layer in costs.layers:
                planes = len(layer.plane_atoms)
                begin = len(self.plane_atoms)
                per_plane = [one / (planes + self.overhead) for row in layer.seconds for one in row]
                self.segments.append(Segment(begin, begin + planes, per_plane,
                                             layer.crossings / planes))
                self.plane_atoms += layer.plane_atoms
        self.planes = len(self.plane_atoms)
        self.segment_begins = [segment.begin for segment in self.segments]
        self.atom_sums = [0, *itertools.accumulate(self.plane_atoms)]
        self.atoms = self.atom_sums[-1]
        self.crossings = copies * sum(layer.crossings for layer in costs.layers)

    def of_all(self, name):
        return self.copies * self.values[name]

    def per_atom(self, name):
        return self.of_all(name) / self.atoms if self.atoms else 0.0

    # ------------------------------------------------------------------------- atoms and planes

    def atoms_below(self, plane):
        """Returns the number of atoms below a plane; the atoms of a plane are spread evenly
        around it."""
        place = min(max(plane + 0.5, 0), self.planes)  # atoms of a plane are within half a spacing
        whole = min(int(place), self.planes - 1)
        return self.atom_sums[whole] + (place - whole) * self.plane_atoms[whole]

    def atoms_near(self, begin, end, distance):
        """Returns the number of atoms within `distance` of a slab and the plane below it."""
        if begin >= end:
            return 0.0
        reach = distance / self.values["spacing"]
        return (self.atoms_below(min(end, self.planes - 1) + reach)
                - self.atoms_below(max(0, begin - 1) - reach))

    def halo(self):
        values = self.values
        return (values["mean_radius"] + 4 * values["max_radius"] + 6 * values["probe_radius"]
                + HALO_SLACK)

    def reach(self):
        values = self.values
        return (values["mean_radius"] + 2 * values["max_radius"] + 4 * values["probe_radius"]
                + REACH_SLACK)

    def segments_of(self, begin, end):
        """Yields segments and their numbers of planes in the range."""
        i = bisect.bisect_right(self.segment_begins, begin) - 1
        while i < len(self.segments) and self.segments[i].begin < end:
            segment = self.segments[i]
            yield segment, min(end, segment.end) - max(begin, segment.begin)
            i += 1

    def crossings_of(self, begin, end):
        return sum(planes * segment.crossings for segment, planes in self.segments_of(begin, end))

    def block_seconds(self, begin, end):
        """Returns the seconds of the blocks of one layer, by column."""
        parts = list(self.segments_of(begin, end))
        scale = 1 + self.overhead / (end - begin)
        if len(parts) == 1:
            (segment, planes), = parts
            return [scale * planes * one for one in segment.seconds]
        return [scale * sum(planes * one for (_, planes), one in zip(parts, column))
                for column in zip(*(segment.seconds for segment, _ in parts))]

    # ----------------------------------------------------------------------------------- slabs

    def estimated_costs(self):
        """Returns the cost of each plane as the program estimates it before the cut."""
        write = self.values["write"]
        crossing = ESTIMATE["crossing"] + ESTIMATE["crossing_text"] * ("edges" in write)
        point = ESTIMATE["point"] + ESTIMATE["point_text"] * ("grid" in write)
        plane = point * self.values["nx"] * self.values["ny"]
        return [plane + ESTIMATE["atom"] * atoms + crossing * segment.crossings
                for segment in self.segments
                for atoms in self.plane_atoms[segment.begin:segment.end]]

    def final_cuts(self, first, ranks):
        """Cuts by estimated costs if this gains more than preparing atoms a second time costs."""
        estimates = self.estimated_costs()
        final = cut_evenly(estimates, ranks)
        gain = max_part(estimates, first) - max_part(estimates, final)
        loss = ESTIMATE["prepared_atom"] * max_part(self.plane_atoms, final)
        return final if gain > loss else first

    def slabs(self, ranks):
        first = cut_evenly(self.plane_atoms, ranks)
        final = self.final_cuts(first, ranks)
        is_same = first == final
        result = []
        for rank in range(ranks):
            begin, end = final[rank], final[rank + 1]
            at_first = self.atoms_near(first[rank], first[rank + 1], self.halo())
            patched = self.atoms_near(begin, end, self.reach())
            surveyed = [patched]
            if ranks > 1:
                surveyed.append(self.atoms_near(first[rank], first[rank + 1], self.reach()))
            result.append(Slab(
                begin, end, 0.0 if is_same else at_first,
                self.atoms_near(begin, end, self.halo()), patched, surveyed,
                self.atoms_near(begin, end, self.values["mean_radius"]),
                self.crossings_of(begin, end) if begin < end else 0))
        return result

    def text_seconds(self, crossings):
        return self.of_all("text_seconds") * crossings / self.crossings if self.crossings else 0.0

    def patch_tasks(self, atoms, threads):
        count = PARTS * threads
        return [self.per_atom("patch_seconds") * atoms / count] * count if atoms > 0 else []

    def patched_up_to(self, slab, plane):
        """Returns the number of atoms whose patches are built before planes up to `plane` are
        solved."""
        return self.atoms_near(slab.begin, plane, self.reach())

    def layers(self, slab, threads):
        """Yields the tasks of each layer of a slab. The plane below it is solved before."""
        patched = self.patched_up_to(slab, slab.begin + 1) if slab.begin else 0.0
        for begin, end in layers_of(slab.begin, slab.end, self.side, self.planes):
            before, patched = patched, self.patched_up_to(slab, end)
            seconds = self.text_seconds(self.crossings_of(begin, end))
            chunks = PARTS * threads
            yield Layer(self.patch_tasks(patched - before, threads),
                        self.block_seconds(begin, end), [seconds / chunks] * chunks)

    def layer_below(self, slab, threads):
        """Returns the tasks of the plane below the slab, which is solved again, and its patches."""
        if slab.begin == 0 or slab.begin >= slab.end:
            return []
        (segment, _), = self.segments_of(slab.begin - 1, slab.begin)
        patched = self.patched_up_to(slab, slab.begin + 1)
        return [Layer(self.patch_tasks(patched, threads),
                      [self.plane_below * one for one in segment.seconds], [0.0])]

    def molecule_seconds(self, atoms, threads):
        """Returns the seconds of the cell list and the diagnostics of `atoms` atoms."""
        return self.per_atom("molecule_seconds") * atoms * (
            MOLECULE_BY_ONE + (1 - MOLECULE_BY_ONE) / threads)

    def plan_seconds(self, atoms):
        """Returns the seconds of taking samples. Each sample costs as much as the patches of an
        atom."""
        patch, all_atoms = self.per_atom("patch_seconds"), self.values["atoms"]
        if not all_atoms:
            return 0.0
        samples = patch * sample_size(all_atoms)
        per_atom = max(0.0, self.values["plan_seconds"] - samples) / all_atoms
        return per_atom * atoms + patch * sample_size(atoms)

    def gather_seconds(self, slabs):
        """Returns, for each slab, the seconds of sending all atoms and receiving those of the slab.

        Each process has read the same number of atoms of each slab.
        """
        ranks = len(slabs)
        if ranks == 1:
            return [0.0]
        times = 2 if any(slab.first_atoms for slab in slabs) else 1
        counts = [slab.first_atoms + slab.atoms for slab in slabs]
        sent = (times * SECONDS_PER_HALVING * math.log2(ranks) * self.atoms
                + SECONDS_PER_SENT_ATOM * sum(counts)) / ranks
        return [sent + SECONDS_PER_RECEIVED_ATOM * count for count in counts]

    def prepare_seconds(self, slab, threads):
        """Returns the seconds of preparing atoms, taking samples and sorting atoms into
        clusters."""
        return (sum(self.molecule_seconds(count, threads)
                    for count in (slab.first_atoms, slab.atoms))
                + sum(map(self.plan_seconds, slab.surveyed))
                + self.per_atom("clusters_seconds") * slab.atoms)

    def read_seconds(self, ranks):
        return (self.of_all("read_seconds") / ranks if ranks > 1
                else self.of_all("read_alone_seconds"))

    def memory(self, slab, threads, ranks):
        """Returns the bytes of the larger step: preparing atoms, or the sweep."""
        always = BASE_MEMORY + threads * THREAD_MEMORY + (MPI_MEMORY if ranks > 1 else 0)
        preparing = PREPARED_ATOM * slab.atoms
        if ranks > 1:
            preparing += READ_ATOM * self.atoms / ranks
        if slab.begin >= slab.end:
            return always + preparing
        layers = layers_of(slab.begin, slab.end, self.side, self.planes)
        fullest = max(self.crossings_of(begin, end) for begin, end in layers)
        # Several threads also solve blocks of the next layer.
        at_a_time = 2 if threads > 1 and len(layers) > 1 else 1
        patched = max(self.patched_at_a_time(slab, begin, last)
                      for (begin, _), (_, last) in zip(layers, layers[at_a_time - 1:]))
        sweeping = (ATOM_MEMORY * slab.atoms + PATCH_MEMORY * patched
                    + at_a_time * CROSSING_MEMORY * fullest)
        return always + max(preparing, sweeping)

    def patched_at_a_time(self, slab, begin, end):
        """Returns the number of atoms whose patches are held while layers of a slab are solved.

        Patches below are held as long as blocks need them. Patches above are built early, because
        the arcs of an atom need the neighbours of its neighbours. Clusters are as high as a cell.
        """
        values, spacing = self.values, self.values["spacing"]
        probe, radius = values["probe_radius"], values["max_radius"]
        below = values["mean_radius"] + 2 * probe + CELL_HEIGHT
        above = below + 2 * (radius + probe) + CELL_HEIGHT
        reach = self.reach() / spacing
        low = max(begin - 1 - below / spacing, slab.begin - 1 - reach)
        high = min(end + above / spacing, slab.end + reach)
        return self.atoms_below(high) - self.atoms_below(low)

    # ----------------------------------------------------------------------------------- a run

    def run(self, ranks, machine):
        slabs = self.slabs(ranks)
        several = ranks > 1
        threads = machine.threads
        messages = several * machine.latency * (ranks - 1)  # seconds of one exchange
        steps = several * machine.latency * math.ceil(math.log2(ranks))

        def received(count, size):
            return several * size * count * (1 - 1 / ranks)

        atoms = max(slab.first_atoms + slab.atoms for slab in slabs)
        areas = max(slab.own_atoms for slab in slabs)
        longest = 0.0
        shares = []
        gathering = self.gather_seconds(slabs)
        for slab, come in zip(slabs, gathering):
            layers = list(self.layers(slab, threads)) if slab.begin < slab.end else []
            below = self.layer_below(slab, threads)
            longest = max(longest, makespan(below, threads, 0)
                          + makespan(layers, threads, BLOCKS_AHEAD * threads))
            cpu = (self.read_seconds(ranks) + come + self.prepare_seconds(slab, 1)
                   + makespan(below + layers, 1, 0)
                   + self.merge_seconds(slab, ranks, machine._replace(threads=1)))
            shares.append(Share(slab.begin, slab.end, slab.atoms, slab.patched, cpu,
                                self.memory(slab, threads, ranks)))
        text, area = self.of_all("text_bytes"), self.of_all("area_bytes")
        read = self.of_all("input_bytes")
        at_once = machine.file_system
        merged = 2 * text + area if several else area
        phases = {
            READ: max(self.read_seconds(ranks), read / at_once),
            EXCHANGE: (max(gathering) + received(atoms, SENT_ATOM) / machine.network
                       + EXCHANGES * messages + REDUCTIONS * steps),
            PREPARE: max(self.prepare_seconds(slab, threads) for slab in slabs),
            SWEEP: max(longest, text / at_once),
            MERGE: max(max(self.merge_seconds(slab, ranks, machine) for slab in slabs),
                       merged / at_once),
            AREAS: several * (received(areas, AREA_SHARE) / machine.network
                              + SECONDS_PER_ADDITION * self.atoms + machine.latency * ranks),
        }
        sent = sum(received(SENT_ATOM * (slab.first_atoms + slab.atoms)
                            + AREA_SHARE * slab.own_atoms, 1) for slab in slabs) / ranks
        sent += several * (CHUNK_INFO * (ranks - 1) + 4 * 8 * self.planes)
        return Run(ranks, sum(phases.values()), phases, sent,
                   max(share.memory for share in shares), shares, read + text + merged)

    def merge_seconds(self, slab, ranks, machine):
        """Returns the seconds of copying the texts of a slab, and of its part of the areas.

        One process alone writes its texts directly. If the kernel cannot copy them, one thread
        reads them and another one writes them.
        """
        area = self.of_all("area_seconds")
        if ranks == 1:
            return area
        both = self.of_all("copy_read_seconds"), self.of_all("copy_write_seconds")
        copying = max(both) if machine.threads > 1 else sum(both)
        if machine.is_local:
            copying = self.of_all("copy_kernel_seconds")
        share = slab.crossings / self.crossings if self.crossings else 0.0
        return share * copying + AREA_TEXTS * area / ranks


# ----------------------------------------------------------------------------------- many runs


def efficiency(run, one):
    return one.seconds / (run.ranks * run.seconds)


def limit(run, one):
    """Returns the step that exceeds its share of one process's time most; None for one process."""
    lost = {name: run.phases[name] - one.phases[name] / run.ranks for name in PHASES}
    name = max(PHASES, key=lost.get)
    return name if lost[name] > 1e-9 * run.seconds else None


def read(path, copies=1):
    return Model(measured.read(path), copies)
