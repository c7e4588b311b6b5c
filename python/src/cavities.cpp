#include "cavities.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "arrays.hpp"
#include "interrupts.hpp"
#include "threads.hpp"

namespace eses::python {
namespace {

constexpr const char* cavities_text =
    R"(cavities(self, probe_radius=None, *, threads=0)
--

Find the cavities: the bounded components of the set of accessible probe centres.

Nothing is sampled: the results have rounding errors only. They do not depend on the number of
threads. Other Python threads run meanwhile. Ctrl-C ends the computation.

Parameters
----------
probe_radius : float, optional
    Radius of the probe, in angstrom: 0, or 0.01 to 1000. The default is that of the surface.
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
    overlap, and ``overlaps_outside`` tells whether the void overlaps that of the outside.

Raises
------
ValueError
    If an argument is out of its range.)";

constexpr const char* pockets_text =
    R"(pockets(self, large_probe=3.0, *, spacing=0.4, min_volume=None, probe_radius=None, threads=0)
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
threads : int, optional
    Number of threads; 0 for all that the process may use.

Returns
-------
list of dict
    The pockets, in descending order of ``volume``. ``probe_center_volume`` is the volume of the
    centres of the probes in the pocket. ``mouth_area`` is the area of the large probe's surface that
    closes it, and ``mouths`` the number of parts of this surface through which the centre of a probe
    can leave it. ``centroid`` is that of the pocket, and ``atoms`` has the indices of the atoms whose
    surface bounds it.

Raises
------
ValueError
    If an argument is out of its range.
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

py::list find_cavities(const Surface& surface, std::optional<double> probe_radius, int threads) {
  MeasureOptions options{
      .probe_radius = probe_radius, .cavities = true, .threads = usable_threads(threads)};
  Measures measures;
  {
    const py::gil_scoped_release unlocked;
    Interrupts interrupts;
    options.check = [&interrupts] { interrupts.check(); };
    measures = measure(surface, options);
  }
  py::list cavities;
  for (const Cavity& cavity : measures.cavities) cavities.append(cavity_dict(cavity));
  return cavities;
}

py::list find_all_pockets(const Surface& surface, double large_probe, double spacing,
                          std::optional<double> min_volume, std::optional<double> probe_radius,
                          int threads) {
  PocketOptions options{.probe_radius = probe_radius,
                        .large_probe_radius = large_probe,
                        .spacing = spacing,
                        .min_volume = min_volume,
                        .threads = usable_threads(threads)};
  Pockets found;
  {
    const py::gil_scoped_release unlocked;
    Interrupts interrupts;
    options.check = [&interrupts] { interrupts.check(); };
    found = find_pockets(surface, options);
  }
  py::list pockets;
  for (const Pocket& pocket : found.pockets) {
    py::dict item;
    item["volume"] = pocket.volume;
    item["probe_center_volume"] = pocket.probe_center_volume;
    item["mouth_area"] = pocket.mouth_area;
    item["mouths"] = pocket.mouth_count;
    item["centroid"] = point_array(pocket.centroid);
    item["atoms"] = index_array(pocket.atoms);
    pockets.append(item);
  }
  return pockets;
}

}  // namespace

void bind_cavities(py::class_<Surface>& surface) {
  surface.def("cavities", &find_cavities, cavities_text, py::arg("probe_radius") = py::none(),
              py::kw_only(), py::arg("threads") = 0);
  const PocketOptions defaults;
  surface.def("pockets", &find_all_pockets, pockets_text,
              py::arg("large_probe") = defaults.large_probe_radius, py::kw_only(),
              py::arg("spacing") = defaults.spacing, py::arg("min_volume") = py::none(),
              py::arg("probe_radius") = py::none(), py::arg("threads") = 0);
}

}  // namespace eses::python
