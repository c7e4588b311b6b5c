#include "cavities.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "interrupts.hpp"
#include "threads.hpp"

namespace eses::python {
namespace {

namespace py = pybind11;

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

py::array point_array(Vec3 point) {
  py::array_t<double> array(3);
  for (std::size_t axis = 0; axis < 3; ++axis)
    array.mutable_at(static_cast<py::ssize_t>(axis)) = point[axis];
  return array;
}

py::array index_array(const std::vector<AtomIndex>& indices) {
  py::array_t<std::int64_t> array(static_cast<py::ssize_t>(indices.size()));
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

}  // namespace

void bind_cavities(py::class_<Surface>& surface) {
  surface.def("cavities", &find_cavities, cavities_text, py::arg("probe_radius") = py::none(),
              py::kw_only(), py::arg("threads") = 0);
}

}  // namespace eses::python
