#include "surface.hpp"

#include <pybind11/stl.h>

#include <cmath>
#include <eses/eses.hpp>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "block_stream.hpp"
#include "cavities.hpp"
#include "chosen_surface.hpp"
#include "computed_result.hpp"
#include "instances.hpp"
#include "interrupts.hpp"
#include "measures.hpp"
#include "run_arguments.hpp"
#include "threads.hpp"
#include "warn.hpp"

namespace eses::python {
namespace {

constexpr const char* class_text =
    R"(Solvent excluded surface of a set of atoms for a spherical probe.

The surface bounds the space that no probe can reach without overlapping a van der Waals sphere.
A surface never changes, and may be used for many grids and by several threads at a time.

Parameters
----------
centers : array_like
    (N, 3) centres of the atoms, in angstrom. Any real type and memory layout is accepted. Without
    ``radii``, anything that ``read_molecule`` accepts, such as a path or a molecule of another
    library.
radii : array_like or str, optional
    (N,) van der Waals radii of the atoms, in angstrom, or for a molecule the name of a set of radii.
probe_radius : float, optional
    Radius of the probe, in angstrom, 0.01 to 1000; 1.4 by default. 0 is the van der Waals surface.
surface : {'ses', 'sas', 'vdw'}, optional
    Which surface: solvent excluded, solvent accessible or van der Waals. The solvent accessible
    surface needs a probe, and the van der Waals surface has none. Both have no cavities to fill, and
    no measures in closed form, which those of the solvent excluded surface contain.
fill_cavities : bool or float, optional
    Whether cavities are filled, so that they are inside. With a number, only those whose voids have
    at most this volume, in cubic angstrom.
threads : int, optional
    Number of threads that index the atoms; 0 for all that the process may use, or one for a few
    thousand atoms.
**options
    ``waters``, ``hydrogens``, ``unknown_radius``, ``frame``, ``select`` and the further arguments of
    ``read_molecule``.

Raises
------
ValueError
    If there are no atoms, if a shape is wrong, if a number is not finite, or if a radius is
    negative. The message names the first such atom by its index, with the value. Also if an
    argument does not fit ``surface``.
TypeError
    If an array does not contain real numbers, or if an argument is unknown or has a wrong type.)";

constexpr const char* init_text =
    R"(__init__(self, centers, radii=None, probe_radius=None, *, surface='ses', fill_cavities=False, threads=0, **options)
--

Check and index the atoms.)";

constexpr const char* grid_text =
    R"(grid(self, spacing=0.4, margin=None, *, origin=None, center=None, shape=None, allow_far_atoms=False)
--

Make a grid around the atoms, or one with a given position and shape.

Parameters
----------
spacing : float, optional
    Distance between neighbouring points, in angstrom.
margin : float, optional
    Distance of the faces of the grid from the van der Waals spheres, in angstrom; 0.8 by default.
    The number of points is truncated, so that up to one spacing of the upper margin may be missing.
origin : sequence of 3 floats, optional
    Position of point (0, 0, 0), in angstrom, for a grid that does not depend on the atoms.
center : sequence of 3 floats, optional
    Middle between the lowest and the highest point, in angstrom; replaces ``origin``.
shape : sequence of 3 ints, optional
    Number of points along x, y and z; needed with ``origin`` and ``center``.
allow_far_atoms : bool, optional
    Whether to make also a grid around the atoms of more than 1e10 points, less than 1 % of which are
    near atoms. From 1e8 such points on, a warning names the atoms that are far from the others.

Returns
-------
Grid
    The grid.

Raises
------
ValueError
    If an argument is out of its range, if there would be more than 2e9 points along an axis or 1e17
    in all, if far atoms are not allowed, or if arguments contradict each other.)";

constexpr const char* compute_text =
    R"(compute(self, grid, *, threads=0, block_size=0, blocks=None, region=None, max_memory=0, inside=True, crossings=True, progress=None)
--

Compute the surface on a grid, in memory.

The results depend on the surface, the grid and the region alone, to the last bit. Other Python
threads run meanwhile. Ctrl-C ends the computation.

Parameters
----------
grid : Grid
    Any grid. Atoms may be outside of it.
threads : int, optional
    Number of threads; 0 for all that the process may use, or fewer to keep ``max_memory``.
block_size : int, optional
    Number of grid points along the side of a block, 2 to 128; 0 chooses it.
blocks : pair of index triples, optional
    First block, and one more than the last block along each axis: only these blocks are computed.
    Blocks have ``block_size`` points on a side, or 64 if it is 0. Neighbouring blocks share their
    faces.
region : pair of index triples, optional
    First point, and one more than the last point along each axis: only these points are computed,
    and the crossings of the edges that start there.
max_memory : int, optional
    Limit of the resident memory of the process, in bytes; 0 for the available memory.
inside : bool, optional
    Whether the result holds the inside points, which take a byte for each point.
crossings : bool, optional
    Whether the result holds the crossings, which take 88 bytes each.
progress : callable, optional
    Called as ``progress(done, total)`` with the number of solved blocks, also from other threads. An
    exception that it raises ends the computation.

Returns
-------
Result
    Area, volume, inside points and crossings.

Raises
------
ValueError
    If an argument is out of its range.
MemoryError
    If the computation needs more memory than there is, or than ``max_memory`` allows.)";

constexpr const char* blocks_text =
    R"(blocks(self, grid, *, threads=0, block_size=0, blocks=None, region=None, max_memory=0)
--

Compute the surface on a grid, and iterate over its blocks as soon as they are solved.

The memory in use does not grow with the number of blocks, so that the grid may be of any size. The
order of the blocks depends on the threads, but their content does not. Ctrl-C ends the loop.

Parameters
----------
grid : Grid
    Any grid. Atoms may be outside of it.
threads, block_size, blocks, region, max_memory : optional
    As for ``compute``.

Returns
-------
BlockIterator
    Iterator over objects of type Block.

Raises
------
ValueError
    If an argument is out of its range.
MemoryError
    If the computation needs more memory than there is, or than ``max_memory`` allows.)";

constexpr const char* diagnostic_text =
    R"(Atoms that are valid and computed exactly, but suspicious.)";

constexpr double default_margin = 0.8;  // angstrom

// Returns the value of the argument `fill_cavities` for a surface.
py::object fill_choice(const ChosenSurface& surface) {
  const std::optional<double> max_void = surface.max_filled_void();
  if (max_void && !std::isinf(*max_void)) return py::float_(*max_void);
  return py::bool_(max_void.has_value());
}

// Returns the radius of the probe of a surface, 0 for the van der Waals surface. Throws if an
// argument does not fit the surface.
double checked_probe_radius(const std::string& kind, const std::optional<double>& probe_radius,
                            const std::optional<double>& max_void) {
  if (kind != "ses" && kind != "sas" && kind != "vdw")
    throw py::value_error("surface must be 'ses', 'sas' or 'vdw', not '" + kind + "'");
  const double probe = probe_radius.value_or(SurfaceOptions().probe_radius);
  if (kind == "ses") return probe;
  if (max_void)
    throw py::value_error("fill_cavities needs the solvent excluded surface, not surface='" + kind +
                          "'");
  if (kind == "vdw") {
    if (probe_radius) throw py::value_error("surface='vdw' has no probe; leave out probe_radius");
    return 0;
  }
  if (!(probe >= min_probe_radius && probe <= max_probe_radius))
    throw py::value_error(
        std::string(py::str("surface='sas' needs a probe_radius from {:g} to {:g}, not {:g}")
                        .format(min_probe_radius, max_probe_radius, probe)));
  return probe;
}

ChosenSurface make_surface(const py::object& centers, const py::object& radii,
                           const std::optional<double>& probe_radius, const std::string& kind,
                           const py::object& fill_cavities, ThreadCount threads) {
  const std::optional<double> max_void = max_filled_void(fill_cavities);
  const double probe = checked_probe_radius(kind, probe_radius, max_void);
  std::vector<Atom> atoms = make_atoms(centers, radii);
  const py::gil_scoped_release unlocked;
  Interrupts interrupts;
  const SurfaceOptions options{.probe_radius = kind == "ses" ? probe : 0,
                               .max_filled_void = max_void,
                               .threads = usable_threads(threads),
                               .check = [&interrupts] { interrupts.check(); },
                               .added_radius = kind == "sas" ? probe : 0};
  std::shared_ptr<const std::vector<Atom>> given;
  if (kind == "sas") given = std::make_shared<const std::vector<Atom>>(atoms);
  return {Surface(std::move(atoms), options), std::move(given), kind, probe};
}

// Makes a surface, and warns of suspicious atoms.
void construct_surface(py::detail::value_and_holder& self, const py::object& centers,
                       const py::object& radii, const std::optional<double>& probe_radius,
                       const std::string& kind, const py::object& fill_cavities,
                       ThreadCount threads, const py::kwargs& options) {
  py::object its_centers = centers, its_radii = radii, files = py::tuple();
  py::object molecule, selector;
  // A molecule of another library, or a file, perhaps with the name or the path of a set of radii.
  const auto reading = py::module_::import("eses_blocks._molecule");
  if (radii.is_none() || py::isinstance<py::str>(radii) || py::hasattr(radii, "__fspath__") ||
      !options.empty() || reading.attr("is_molecule")(centers).cast<bool>()) {
    const py::tuple found = reading.attr("read_with_selector")(centers, radii, options);
    molecule = found[0];
    selector = found[1];
    its_centers = molecule.attr("centers");
    its_radii = molecule.attr("radii");
    files = molecule.attr("files");
  }
  ChosenSurface surface =
      make_surface(its_centers, its_radii, probe_radius, kind, fill_cavities, threads);
  warn_about(surface.diagnostics());
  construct(self, std::move(surface), files);
  if (selector)
    py::module_::import("eses_blocks._select")
        .attr("remember_molecule")(py::handle(reinterpret_cast<PyObject*>(self.inst)),
                                   molecule.attr("kept"), selector);
}

py::tuple surface_state(const py::object& surface) {
  return py::make_tuple(surface.attr("centers"), surface.attr("radii"),
                        surface.attr("probe_radius"), surface.attr("fill_cavities"),
                        surface.attr("surface"), files_of(surface),
                        py::module_::import("eses_blocks._select").attr("molecule_of")(surface));
}

void set_surface_state(py::detail::value_and_holder& self, const py::tuple& state) {
  const auto [centers, radii, probe_radius, fill_cavities, kind, files, molecule] =
      unpack_state<std::tuple<py::object, py::object, double, py::object, std::string, py::tuple,
                              std::optional<std::pair<py::array, py::object>>>>(state);
  const auto probe = kind == "vdw" ? std::nullopt : std::optional(probe_radius);
  construct(self, make_surface(centers, radii, probe, kind, fill_cavities, {1}), files);
  if (molecule)
    py::module_::import("eses_blocks._select")
        .attr("remember_molecule")(py::handle(reinterpret_cast<PyObject*>(self.inst)),
                                   molecule->first, molecule->second);
}

Grid make_surface_grid(const ChosenSurface& surface, double spacing, std::optional<double> margin,
                       const std::optional<Triple>& origin, const std::optional<Triple>& center,
                       const std::optional<GridIndex>& shape, bool allow_far_atoms) {
  if (!origin && !center && !shape) {
    const GridOptions options{.spacing = spacing, .margin = margin.value_or(default_margin)};
    check_far_atoms(surface, options, allow_far_atoms);
    const py::gil_scoped_release unlocked;
    return make_grid(surface, options);
  }
  if (!shape) throw py::value_error("origin and center need a shape");
  if (origin.has_value() == center.has_value())
    throw py::value_error("a shape needs either an origin or a center");
  if (margin) throw py::value_error("margin cannot be given together with shape");
  const Grid grid = origin ? Grid{as_vector(*origin), spacing, *shape}
                           : centered_grid(as_vector(*center), spacing, *shape);
  validate(grid);
  return grid;
}

ProgressCallback make_progress(Interrupts& interrupts, const py::object& callback) {
  if (callback.is_none()) return [&interrupts](std::int64_t, std::int64_t) { interrupts.check(); };
  return [&interrupts, &callback](std::int64_t done, std::int64_t total) {
    interrupts.check();
    const py::gil_scoped_acquire lock;
    callback(done, total);
  };
}

std::shared_ptr<ComputedResult> compute_result(const ChosenSurface& surface, const Grid& grid,
                                               ThreadCount threads, const py::object& block_size,
                                               const std::optional<IndexCorners>& blocks,
                                               const std::optional<IndexCorners>& region,
                                               const py::object& max_memory, bool inside,
                                               bool crossings, const py::object& progress) {
  if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
    throw py::type_error("progress must be callable");
  const RunOptions options = make_options(
      grid, {threads, block_size_of(block_size), blocks, region, memory_limit(max_memory)});
  Interrupts interrupts;
  RunOptions with_progress = options;
  with_progress.progress = make_progress(interrupts, progress);
  const py::gil_scoped_release unlocked;
  return std::make_shared<ComputedResult>(
      compute(surface, grid, with_progress, {.inside = inside, .crossings = crossings}), surface,
      options);
}

BlockStreamPointer stream_blocks(const ChosenSurface& surface, const Grid& grid,
                                 ThreadCount threads, const py::object& block_size,
                                 const std::optional<IndexCorners>& blocks,
                                 const std::optional<IndexCorners>& region,
                                 const py::object& max_memory) {
  constexpr std::size_t max_waiting = 4;
  RunOptions options = make_options(
      grid, {threads, block_size_of(block_size), blocks, region, memory_limit(max_memory)});
  const py::gil_scoped_release unlocked;
  return BlockStreamPointer(new BlockStream(surface, grid, std::move(options), max_waiting));
}

py::list examples_of(const Diagnostic& diagnostic) {
  py::list examples;
  for (const Diagnostic::Example& example : diagnostic.examples)
    examples.append(py::make_tuple(example.atom, example.other));
  return examples;
}

py::tuple diagnostic_state(const Diagnostic& diagnostic) {
  py::list examples;
  for (const auto& [atom, other, line] : diagnostic.examples)
    examples.append(py::make_tuple(atom, other, line));
  return py::make_tuple(static_cast<int>(diagnostic.kind), diagnostic.count, examples);
}

Diagnostic diagnostic_of_state(const py::tuple& state) {
  using Example = std::tuple<AtomIndex, AtomIndex, std::uint64_t>;
  const auto [kind, count, examples] =
      unpack_state<std::tuple<std::size_t, std::uint64_t, std::vector<Example>>>(state);
  if (kind >= diagnostic_kinds)
    throw py::value_error("the state is not one that this class has pickled");
  Diagnostic diagnostic{static_cast<DiagnosticKind>(kind), count, {}};
  for (const auto& [atom, other, line] : examples)
    diagnostic.examples.push_back({atom, other, line});
  return diagnostic;
}

void bind_diagnostic(py::module_& module) {
  py::class_<Diagnostic> type(module, "Diagnostic", diagnostic_text);
  type.attr("__module__") = "eses_blocks";
  type.def_property_readonly(
          "kind", [](const Diagnostic& self) { return std::string(name_of(self.kind)); },
          "str: what is suspicious.\n\n"
          "``duplicate``: the atom has the centre and the radius of an earlier one. ``close``: its "
          "centre is within 0.5 angstrom of an earlier one's. ``nested``: it is larger than a "
          "hydrogen and lies inside another atom. ``large_radius``: its radius is above 4 "
          "angstrom. "
          "``small_radii``: every radius is below 0.4 angstrom, as if in nanometres. "
          "``one_atom_residue``: it is alone in its residue, or CA with CB alone, as in most "
          "residues "
          "of the file. "
          "``foreign_residue``: its residue has atoms that an amino acid or nucleotide of this "
          "name "
          "cannot have, or no backbone. ``nanometre_coordinates``: most atoms are within 0.45 "
          "angstrom "
          "of their neighbours, as if in nanometres. ``unread_record``: a line with coordinates "
          "has "
          "an unknown record name. "
          "``zero_radius``: its radius is 0. ``nested_usual``: a hydrogen lies inside another "
          "atom. ``water``: it belongs to a water molecule of a PQR file.")
      .def_property_readonly(
          "count", [](const Diagnostic& self) { return self.count; },
          "int: number of atoms with this diagnostic.")
      .def_property_readonly("examples", &examples_of,
                             "list of pairs of ints: the first five of these atoms, each with the "
                             "other atom involved, or with itself if there is none.")
      .def_property_readonly(
          "is_usual", [](const Diagnostic& self) { return is_usual(self.kind); },
          "bool: whether correct files often have such atoms.")
      .def(
          "__eq__", [](const Diagnostic& self, const Diagnostic& other) { return self == other; },
          py::is_operator())
      .def("__hash__",
           [](const Diagnostic& self) {
             return py::hash(py::make_tuple(static_cast<int>(self.kind), self.count));
           })
      .def("__str__", [](const Diagnostic& self) { return describe(self); })
      .def("__repr__",
           [](const Diagnostic& self) {
             return py::str("<eses_blocks.Diagnostic: {} (count {})>")
                 .format(std::string(name_of(self.kind)), self.count);
           })
      .def(py::pickle(&diagnostic_state, &diagnostic_of_state));
  protect_instances(type);
}

// The constructor, the representation and the properties.
void bind_properties(py::class_<ChosenSurface>& type) {
  type.def("__init__", &construct_surface, py::detail::is_new_style_constructor(), init_text,
           py::arg("centers"), py::arg("radii") = py::none(), py::arg("probe_radius") = py::none(),
           py::kw_only(), py::arg("surface") = "ses", py::arg("fill_cavities") = false,
           py::arg("threads") = 0)
      .def("__len__", [](const ChosenSurface& self) { return self.atoms().size(); })
      .def("__repr__",
           [](const ChosenSurface& self) {
             const std::string kind = self.kind == "ses" ? "" : ", " + self.kind;
             const py::str probe = py::str(", probe radius {}").format(self.chosen_probe_radius);
             return py::str("<eses_blocks.Surface: {} atoms{}{}>")
                 .format(self.atoms().size(), kind, self.kind == "vdw" ? py::str() : probe);
           })
      .def_property_readonly(
          "surface", [](const ChosenSurface& self) { return self.kind; },
          "str: which surface: ``ses``, ``sas`` or ``vdw``.")
      .def_property_readonly(
          "probe_radius", [](const ChosenSurface& self) { return self.chosen_probe_radius; },
          "float: radius of the probe, in angstrom; 0 for the van der Waals surface.")
      .def_property_readonly("fill_cavities", &fill_choice,
                             "bool or float: whether cavities are filled, or the maximum volume of "
                             "the voids that are, in cubic angstrom.")
      .def_property_readonly(
          "centers",
          [](const py::object& self) {
            return centers_view(self.cast<const ChosenSurface&>().given_atoms(), self);
          },
          "(N, 3) float64: centres of the atoms, in angstrom; read-only.")
      .def_property_readonly(
          "radii",
          [](const py::object& self) {
            return radii_view(self.cast<const ChosenSurface&>().given_atoms(), self);
          },
          "(N,) float64: van der Waals radii of the atoms, in angstrom; read-only.")
      .def_property_readonly(
          "diagnostics",
          [](const ChosenSurface& self) {
            const std::span<const Diagnostic> found = self.diagnostics();
            return std::vector<Diagnostic>(found.begin(), found.end());
          },
          "list of Diagnostic: suspicious properties of the atoms.");
}

}  // namespace

void require_excluded(const ChosenSurface& surface, const std::string& method,
                      const std::string& hint) {
  if (surface.kind == "ses") return;
  throw std::invalid_argument("Surface." + method +
                              " needs the solvent excluded surface, not surface='" + surface.kind +
                              "'" + hint);
}

// A boolean is also a real number, so it is recognized first. Scalars of other libraries are arrays
// without an axis, or have the methods of one.
std::optional<double> max_filled_void(const py::object& fill_cavities) {
  const bool is_scalar = py::hasattr(fill_cavities, "item") &&
                         py::getattr(fill_cavities, "ndim", py::int_(1)).equal(py::int_(0));
  const py::object value = is_scalar ? fill_cavities.attr("item")() : fill_cavities;
  if (py::isinstance<py::bool_>(value)) {
    if (!value.cast<bool>()) return std::nullopt;
    return std::numeric_limits<double>::infinity();
  }
  if (!py::hasattr(value, "ndim")) {
    const double volume = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred() == nullptr) return volume;
    if (PyErr_ExceptionMatches(PyExc_TypeError) == 0) throw py::error_already_set();
    PyErr_Clear();
  }
  throw py::type_error("fill_cavities must be a boolean or a volume in cubic angstrom, not " +
                       py::repr(fill_cavities).cast<std::string>());
}

void bind_surface(py::module_& module) {
  bind_diagnostic(module);
  py::class_<ChosenSurface> type(module, "Surface", class_text);
  type.attr("__module__") = "eses_blocks";
  bind_properties(type);
  type.def("grid", &make_surface_grid, grid_text, py::arg("spacing") = 0.4,
           py::arg("margin") = py::none(), py::kw_only(), py::arg("origin") = py::none(),
           py::arg("center") = py::none(), py::arg("shape") = py::none(),
           py::arg("allow_far_atoms") = false)
      .def("compute", &compute_result, compute_text, py::arg("grid"), py::kw_only(),
           py::arg("threads") = 0, py::arg("block_size") = 0, py::arg("blocks") = py::none(),
           py::arg("region") = py::none(), py::arg("max_memory") = 0, py::arg("inside") = true,
           py::arg("crossings") = true, py::arg("progress") = py::none())
      .def("blocks", &stream_blocks, blocks_text, py::arg("grid"), py::kw_only(),
           py::arg("threads") = 0, py::arg("block_size") = 0, py::arg("blocks") = py::none(),
           py::arg("region") = py::none(), py::arg("max_memory") = 0)
      .def("__getstate__", &surface_state)
      .def("__setstate__", &set_surface_state, py::detail::is_new_style_constructor());
  protect_instances(type);
  bind_measures(module, type);
  bind_cavities(type);
}

}  // namespace eses::python
