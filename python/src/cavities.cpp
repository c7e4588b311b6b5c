#include "cavities.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "interrupts.hpp"
#include "threads.hpp"
#include "warn.hpp"

namespace eses::python {
namespace {

constexpr const char* cavities_text =
    R"(cavities(self, probe_radius=None, *, at=None, atoms=None, balls=None, threads=0)
--

Find the cavities: the bounded components of the set of accessible probe centres.

Nothing is sampled: the results have rounding errors only. They do not depend on the number of
threads. Other Python threads run meanwhile. Ctrl-C ends the computation.

Parameters
----------
probe_radius : float, optional
    Radius of the probe, in angstrom: 0, or 0.01 to 1000. The default is that of the surface.
at : str, object or array_like, optional
    A place: a selection as ``report`` of ``measure``, of a surface of a file or molecule; a part of a
    molecule, such as an AtomGroup or a gemmi.Residue; a point (3,); or the lowest and highest corner
    of a box (2, 3). Only what has a point within a probe radius of the point, in the box, or in a
    ball of a ligand (``ligand:STI``), which is left out of the surface, is returned, or what the
    atoms of another selection bound. A part without amino acids and nucleotides is a ligand. It may
    be a molecule of its own.
atoms : sequence of int, optional
    A place: atoms. What they bound is at the place.
balls : tuple of array_like, optional
    A place: centres (N, 3) and radii (N,) of balls, such as the atoms of a ligand that is no part of
    the surface.
threads : int, optional
    Number of threads; 0 for all that the process may use.

Returns
-------
list of dict
    The cavities, in descending order of their void volumes. Volumes are ``void_volume`` and
    ``probe_center_volume``, areas ``ses_area`` and ``sas_area``. ``euler_number`` is that of the
    surface of the probe centres, and ``walls`` the number of its closed parts. Points are
    ``centroid`` (of the probe centres), ``low`` and ``high`` (corners of the box around the void)
    and ``largest_probe_center``; ``largest_probe`` is the radius of the largest sphere that fits.
    ``atoms`` has the indices of the adjacent atoms, ``overlaps`` the indices of cavities whose voids
    overlap, and ``overlaps_outside`` tells whether the void overlaps that of the outside. ``index`` is the index
    among all cavities.

Raises
------
ValueError
    If an argument is out of its range.)";

constexpr const char* pockets_text =
    R"(pockets(self, large_probe=3.0, *, spacing=0.4, min_volume=None, probe_radius=None, at=None, atoms=None, balls=None, threads=0, allow_far_atoms=False)
--

Find the pockets: connected parts of space that the probe reaches from outside and a large probe
does not.

Unlike all other measures, the results are sums over a grid, so that they depend on its spacing.
Cavities are not pockets. The results do not depend on the number of threads. Other Python threads
run meanwhile. Ctrl-C ends the computation.

Parameters
----------
large_probe : float, optional
    Radius of the large probe, in angstrom; more than that of the probe, up to 1000.
spacing : float, optional
    Distance of the grid points, in angstrom; a 32nd of the radius of the probe, up to its radius.
min_volume : float, optional
    Pockets with less volume, in cubic angstrom, are left out. The default is twice the volume of
    the probe.
probe_radius : float, optional
    Radius of the probe, in angstrom, 0.01 to 1000. The default is that of the surface.
at : str, object or array_like, optional
    A place: a selection as ``report`` of ``measure``, of a surface of a file or molecule; a part of a
    molecule, such as an AtomGroup or a gemmi.Residue; a point (3,); or the lowest and highest corner
    of a box (2, 3). Only what has a point within a probe radius of the point, in the box, or in a
    ball of a ligand (``ligand:STI``), which is left out of the surface, is returned, or what the
    atoms of another selection bound. A part without amino acids and nucleotides is a ligand. It may
    be a molecule of its own.
atoms : sequence of int, optional
    A place: atoms. What they bound is at the place.
balls : tuple of array_like, optional
    A place: centres (N, 3) and radii (N,) of balls, such as the atoms of a ligand that is no part of
    the surface.
threads : int, optional
    Number of threads; 0 for all that the process may use.
allow_far_atoms : bool, optional
    As for ``grid``.

Returns
-------
list of dict
    The pockets, in descending order of ``volume``. ``probe_center_volume`` is the volume of the
    centres of the probes in the pocket. ``mouth_area`` is the area of the large probe's surface that
    closes it, and ``mouths`` the number of parts of this surface through which the centre of a probe
    can leave it. ``centroid`` is that of the pocket, and ``atoms`` has the indices of the atoms whose
    surface bounds it. Pockets at a place have also ``low`` and ``high``, the corners of the box
    around them, ``depth``, the largest distance of a probe centre from the nearest one at a mouth,
    and ``volume_at_place``, the volume in the balls and the box.

Raises
------
ValueError
    If an argument is out of its range, or if far atoms are not allowed.
MemoryError
    If the grid needs more memory than there is.)";

py::array point_array(Vec3 point) {
  auto array = make_array<double>(3);
  for (std::size_t axis = 0; axis < 3; ++axis)
    array.mutable_at(static_cast<py::ssize_t>(axis)) = point[axis];
  return array;
}

py::array index_array(const std::vector<AtomIndex>& indices) {
  auto array = make_array<std::int64_t>(static_cast<py::ssize_t>(indices.size()));
  std::copy(indices.begin(), indices.end(), array.mutable_data());
  return array;
}

py::dict cavity_dict(const Cavity& cavity) {
  py::dict item;
  item["void_volume"] = cavity.void_volume;
  item["probe_center_volume"] = cavity.probe_center_volume;
  item["ses_area"] = cavity.ses_area;
  item["sas_area"] = cavity.sas_area;
  item["euler_number"] = cavity.euler_number;
  item["centroid"] = point_array(cavity.centroid);
  item["low"] = point_array(cavity.low);
  item["high"] = point_array(cavity.high);
  item["largest_probe"] = cavity.largest_probe;
  item["largest_probe_center"] = point_array(cavity.largest_probe_center);
  item["walls"] = cavity.wall_count;
  item["atoms"] = index_array(cavity.atoms);
  item["overlaps"] = cavity.overlaps;
  item["overlaps_outside"] = cavity.overlaps_outside;
  return item;
}

/// Returns the value of an argument. Raises TypeError, which says what it must be.
template <class Value>
Value cast_argument(const py::object& argument, const char* what) {
  try {
    return argument.cast<Value>();
  } catch (const py::cast_error&) {
    throw py::type_error(std::string(what) + ", not " + py::repr(argument).cast<std::string>());
  }
}

/// Makes a place from a point or the two corners of a box, atoms and balls; nothing without any.
std::optional<Place> place_of(const py::object& at, const py::object& atoms,
                              const py::object& balls, double probe_radius) {
  if (at.is_none() && atoms.is_none() && balls.is_none()) return std::nullopt;
  Place place;
  if (!at.is_none()) {
    const py::array_t<double> array = as_doubles(real_array(at, "at"));
    const auto row = [&](const double* begin) { return Vec3{begin[0], begin[1], begin[2]}; };
    const auto values = py::array_t<double, py::array::c_style | py::array::forcecast>(array);
    if (values.ndim() == 1 && values.size() == 3)
      place.balls.push_back({row(values.data()), probe_radius});
    else if (values.ndim() == 2 && values.shape(0) == 2 && values.shape(1) == 3)
      place.box = {row(values.data()), row(values.data() + 3)};
    else
      throw py::value_error(
          "at must be a point of shape (3,), or the corners of a box of shape "
          "(2, 3), not " +
          shape_text(array));
  }
  if (!atoms.is_none())
    for (const auto index :
         cast_argument<std::vector<std::int64_t>>(atoms, "atoms must be a sequence of indices")) {
      if (index < 0 || index > std::int64_t{0xffffffff})
        throw py::value_error("atoms: there is no atom " + std::to_string(index));
      place.atoms.push_back(static_cast<AtomIndex>(index));
    }
  if (!balls.is_none()) {
    const auto [centers, radii] = cast_argument<std::pair<py::object, py::object>>(
        balls, "balls must be a pair of centers and radii");
    const std::vector<Atom> given = make_atoms(centers, radii);
    place.balls.insert(place.balls.end(), given.begin(), given.end());
  }
  return place;
}

/// Returns whether a place is a selection of atoms or a part of a molecule.
bool names_atoms(const py::object& at) {
  return !at.is_none() &&
         py::module_::import("eses_blocks._places").attr("names_atoms")(at).cast<bool>();
}

/// Finds what `method` finds at a selection of atoms.
py::list find_at_selection(const ChosenSurface& surface, const char* method, const py::object& at,
                           const py::object& atoms, const py::object& balls,
                           const py::dict& options) {
  if (!atoms.is_none() || !balls.is_none())
    throw py::value_error("a selection at= cannot be combined with atoms= and balls=");
  const py::object find = py::module_::import("eses_blocks._places").attr("find_at");
  return find(py::cast(&surface, py::return_value_policy::reference), method, at, options);
}

py::list find_cavities(const ChosenSurface& surface, std::optional<double> probe_radius,
                       const py::object& at, const py::object& atoms, const py::object& balls,
                       ThreadCount threads) {
  require_excluded(surface, "cavities");
  if (names_atoms(at))
    return find_at_selection(
        surface, "cavities", at, atoms, balls,
        py::dict(py::arg("probe_radius") = probe_radius, py::arg("threads") = threads));
  const std::optional<Place> place =
      place_of(at, atoms, balls, probe_radius.value_or(surface.probe_radius()));
  MeasureOptions options{
      .probe_radius = probe_radius, .cavities = true, .threads = usable_threads(threads)};
  Measures measures;
  std::vector<std::size_t> chosen;
  {
    const py::gil_scoped_release unlocked;
    Interrupts interrupts;
    options.check = [&interrupts] { interrupts.check(); };
    measures = measure(surface, options);
    if (place)
      chosen = find_cavities_at(
          surface, *place,
          {.probe_radius = probe_radius, .threads = options.threads, .check = options.check});
  }
  py::list cavities;
  for (std::size_t k = 0; k < measures.cavities.size(); ++k) {
    if (place && !std::ranges::binary_search(chosen, k)) continue;
    py::dict item = cavity_dict(measures.cavities[k]);
    item["index"] = k;
    cavities.append(item);
  }
  return cavities;
}

py::dict pocket_dict(const Pocket& pocket) {
  py::dict item;
  item["volume"] = pocket.volume;
  item["probe_center_volume"] = pocket.probe_center_volume;
  item["mouth_area"] = pocket.mouth_area;
  item["mouths"] = pocket.mouth_count;
  item["centroid"] = point_array(pocket.centroid);
  item["atoms"] = index_array(pocket.atoms);
  return item;
}

/// Returns `find()`, which runs without the interpreter's lock and may be interrupted.
template <class Find>
auto find_interruptibly(PocketOptions& options, Find&& find) {
  const py::gil_scoped_release unlocked;
  Interrupts interrupts;
  options.check = [&interrupts] { interrupts.check(); };
  return find();
}

py::list find_all_pockets(const ChosenSurface& surface, double large_probe, double spacing,
                          std::optional<double> min_volume, std::optional<double> probe_radius,
                          const py::object& at, const py::object& atoms, const py::object& balls,
                          ThreadCount threads, bool allow_far_atoms) {
  require_excluded(surface, "pockets");
  if (names_atoms(at))
    return find_at_selection(
        surface, "pockets", at, atoms, balls,
        py::dict(py::arg("large_probe") = large_probe, py::arg("spacing") = spacing,
                 py::arg("min_volume") = min_volume, py::arg("probe_radius") = probe_radius,
                 py::arg("threads") = threads, py::arg("allow_far_atoms") = allow_far_atoms));
  const std::optional<Place> place =
      place_of(at, atoms, balls, probe_radius.value_or(surface.probe_radius()));
  check_far_atoms(surface, {.spacing = spacing, .margin = 2 * spacing}, allow_far_atoms);
  PocketOptions options{.probe_radius = probe_radius,
                        .large_probe_radius = large_probe,
                        .spacing = spacing,
                        .min_volume = min_volume,
                        .threads = usable_threads(threads)};
  py::list pockets;
  if (!place) {
    const Pockets found =
        find_interruptibly(options, [&] { return find_pockets(surface, options); });
    for (const Pocket& pocket : found.pockets) pockets.append(pocket_dict(pocket));
    return pockets;
  }
  const PlacedPockets found =
      find_interruptibly(options, [&] { return find_pockets_at(surface, *place, options); });
  for (const PlacedPocket& placed : found.pockets) {
    py::dict item = pocket_dict(placed.pocket);
    item["low"] = point_array(placed.low);
    item["high"] = point_array(placed.high);
    item["depth"] = placed.depth;
    item["volume_at_place"] = placed.volume_at_place;
    pockets.append(item);
  }
  return pockets;
}

}  // namespace

void bind_cavities(py::class_<ChosenSurface>& surface) {
  surface.def("cavities", &find_cavities, cavities_text, py::arg("probe_radius") = py::none(),
              py::kw_only(), py::arg("at") = py::none(), py::arg("atoms") = py::none(),
              py::arg("balls") = py::none(), py::arg("threads") = 0);
  const PocketOptions defaults;
  surface.def("pockets", &find_all_pockets, pockets_text,
              py::arg("large_probe") = defaults.large_probe_radius, py::kw_only(),
              py::arg("spacing") = defaults.spacing, py::arg("min_volume") = py::none(),
              py::arg("probe_radius") = py::none(), py::arg("at") = py::none(),
              py::arg("atoms") = py::none(), py::arg("balls") = py::none(), py::arg("threads") = 0,
              py::arg("allow_far_atoms") = false);
}

}  // namespace eses::python
