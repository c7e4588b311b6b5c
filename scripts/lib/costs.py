"""Files with the measured costs of a structure's blocks, patches and texts.

scripts/benchmarks/simulate writes and reads them.

A line consists of fields with commas between them. Most lines are a name and its value. Each layer
of blocks, from below, has the lines `crossings,BZ,N` and `plane_atoms,BZ,N N ...` (atoms nearest to
each of its planes). Each row of blocks has the line `blocks,BZ,BY,T T ...` (microseconds). Empty
lines and lines that begin with # are ignored.
"""

import collections
import math

from common import Failed, complete_file

# All seconds are CPU seconds of one thread.
# input_bytes, text_bytes, area_bytes: size of the input, of points and edges, and of areas.
# mean_radius, max_radius: radius of the atoms, angstrom.
# read_seconds: reading the atoms; read_alone_seconds: the same by one process alone.
# molecule_seconds: preparing atoms; plan_seconds: taking samples and making the plan.
# clusters_seconds: sorting atoms into clusters; patch_seconds: building all patches.
# text_seconds: making and writing texts.
# copy_read_seconds, copy_write_seconds: reading texts, and writing them to another file.
# copy_kernel_seconds: copying texts by copy_file_range.
# area_seconds: adding up and writing areas.
# block_nx, block_ny, block_nz: points on the sides of a block.
# thin_planes: cost of a layer of blocks of one plane, divided by that of a plane of whole blocks.
NUMBERS = ("atoms", "input_bytes", "text_bytes", "area_bytes", "spacing", "probe_radius", "lower_z",
           "block_nx", "block_ny", "block_nz", "nx", "ny", "nz", "mean_radius", "max_radius",
           "read_seconds", "read_alone_seconds", "molecule_seconds", "plan_seconds",
           "clusters_seconds", "patch_seconds", "text_seconds", "copy_read_seconds",
           "copy_write_seconds", "copy_kernel_seconds", "area_seconds", "thin_planes")
WORDS = ("structure", "date", "cpu", "cores", "build", "write")

# seconds: cost of each block, [by][bx]. plane_atoms: a number for each plane.
Layer = collections.namedtuple("Layer", "seconds plane_atoms crossings")
# values: numbers and words by name. layers: from below.
Costs = collections.namedtuple("Costs", "values layers")


def block_count(values, axis):
    """Returns the number of blocks along an axis: x, y or z."""
    return (max(int(values["n" + axis]), 2) - 2) // (int(values["block_n" + axis]) - 1) + 1


def layer_planes(values):
    """Returns the number of planes that each layer of blocks owns."""
    side, layers = int(values["block_nz"]) - 1, block_count(values, "z")
    return [side] * (layers - 1) + [int(values["nz"]) - side * (layers - 1)]


def write(path, costs):
    with complete_file(path, encoding="utf-8") as target:
        target.write("# What a structure costs; written and read by scripts/benchmarks/simulate.\n")
        for name in (*WORDS, *NUMBERS):
            value = costs.values[name]
            target.write(f"{name},{value:.9g}\n" if isinstance(value, float)
                         else f"{name},{value}\n")
        for bz, layer in enumerate(costs.layers):
            target.write(f"crossings,{bz},{layer.crossings}\n"
                         f"plane_atoms,{bz},{' '.join(map(str, layer.plane_atoms))}\n")
            for by, row in enumerate(layer.seconds):
                target.write(f"blocks,{bz},{by},{' '.join(f'{1e6 * s:.0f}' for s in row)}\n")


# ------------------------------------------------------------------------------------- reading


def number(text, what=float):
    try:
        value = what(text)
    except ValueError:
        raise Failed(f"expected a number, found {text[:40]!a}") from None
    if not math.isfinite(value):
        raise Failed(f"expected a number, found {text[:40]!a}")
    return value


def not_negative(text, what=float):
    value = number(text, what)
    if value < 0:
        raise Failed(f"{text} is negative")
    return value


def take_line(line, values, tables):
    name, *fields = line.split(",")
    if name in tables:
        places = 2 if name == "blocks" else 1
        if len(fields) != places + 1:
            raise Failed(f"{name}: expected {places + 1} fields, found {len(fields)}")
        place = tuple(not_negative(field, int) for field in fields[:places])
        whole = name != "blocks"
        numbers = [not_negative(text, int if whole else float) for text in fields[-1].split()]
        if tables[name].setdefault(place, numbers) is not numbers:
            raise Failed(f"{name} of {', '.join(map(str, place))} a second time")
        return
    if name not in WORDS + NUMBERS:
        raise Failed(f"no such value: {name[:40]!a}")
    if name in values:
        raise Failed(f"{name} a second time")
    text = line.partition(",")[2]
    if name in WORDS:
        values[name] = text
    else:
        values[name] = number(text) if name == "lower_z" else not_negative(text)


def make_layers(values, tables):
    for name in WORDS + NUMBERS:
        if name not in values:
            raise Failed(f" no value of {name}")
    for name in ("spacing", "nx", "ny", "nz"):
        if values[name] <= 0:
            raise Failed(f" {name} must be above 0")
    for name in ("block_nx", "block_ny", "block_nz"):
        if values[name] < 2:
            raise Failed(f" {name} must be at least 2")
    columns, rows = block_count(values, "x"), block_count(values, "y")

    def table(name, place, count):
        numbers = tables[name].pop(place, None)
        where = f"{name} of {', '.join(map(str, place))}"
        if numbers is None:
            raise Failed(f" no {where}")
        if len(numbers) != count:
            raise Failed(f" {where}: expected {count} numbers, found {len(numbers)}")
        return numbers

    layers = []
    for bz, planes in enumerate(layer_planes(values)):
        seconds = [[1e-6 * one for one in table("blocks", (bz, by), columns)] for by in range(rows)]
        layers.append(Layer(seconds, table("plane_atoms", (bz,), planes),
                            table("crossings", (bz,), 1)[0]))
    for name, left in tables.items():
        for place in left:
            raise Failed(f" {name} of {', '.join(map(str, place))} is outside the grid")
    return layers


def read(path):
    """Reads a file. Throws Failed, with the line if there is one, if `write` has not made the
    file."""
    values, tables = {}, {"crossings": {}, "plane_atoms": {}, "blocks": {}}
    try:
        with open(path, encoding="utf-8", errors="replace") as source:
            for count, line in enumerate(source, 1):
                line = line.rstrip("\n")
                if not line or line.startswith("#"):
                    continue
                try:
                    take_line(line, values, tables)
                except Failed as error:
                    raise Failed(f"{count}: {error}") from None
        return Costs(values, make_layers(values, tables))
    except Failed as error:
        raise Failed(f"{path}:{error}") from None
