#include "solver_maps.hpp"

#include <array>
#include <cstdint>
#include <eses/eses.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "interrupts.hpp"
#include "threads.hpp"

namespace eses::python {
namespace {

constexpr const char* dielectric_text = R"(dielectric(self, solute=2.0, solvent=78.54)
--

Compute the dielectric at the middles of the grid edges.

Finite-difference Poisson-Boltzmann solvers take these three maps, such as APBS with ``usemap diel``.
An edge of which the fraction t lies inside the surface has ``1 / (t / solute + (1 - t) / solvent)``.
The values are those that ``eses-blocks --dielectric`` writes. They take 24 bytes for each point, and
about the time of ``Surface.compute``.

Parameters
----------
solute : float, optional
    Relative permittivity inside the surface, 1e-9 to 1e9.
solvent : float, optional
    Relative permittivity outside the surface, 1e-9 to 1e9.

Returns
-------
tuple of 3 numpy.ndarray
    (nx, ny, nz) float64 for the edges along x, y and z. Element ``[i, j, k]`` belongs to the edge that
    starts at this point of the grid, or of the region. Its place is the point, shifted by half a
    spacing along the axis. Edges that end beyond the grid have the value of the solvent.

Raises
------
ValueError
    If a permittivity is out of its range.
MemoryError
    If the computation needs more memory than there is, or than ``max_memory`` of ``compute`` allows.)";

constexpr const char* kappa_text = R"(kappa(self, ion_radius=2.0)
--

Compute to which points the centres of ions have access.

These are the points outside all spheres of the van der Waals radius plus that of the ions, as APBS
takes them with ``usemap kappa``. The values are those that ``eses-blocks --kappa`` writes. They take
about the time of ``Surface.compute``.

Parameters
----------
ion_radius : float, optional
    Radius of the ions, in angstrom, 0 to 1000.

Returns
-------
numpy.ndarray
    (nx, ny, nz) bool: whether ions have access to each point of the grid, or of the region.

Raises
------
ValueError
    If the radius is out of its range.
MemoryError
    If the computation needs more memory than there is, or than ``max_memory`` of ``compute`` allows.)";

/// Calls `compute(options)` without the interpreter's lock, and with options that look for
/// interrupts.
template <class Compute>
auto compute_map(const ComputedResult& result, Compute&& compute) {
  const py::gil_scoped_release unlocked;
  Interrupts interrupts;
  RunOptions options = result.options;
  options.threads = usable_threads(options.threads);  // the process may be a fork by now
  options.progress = [&interrupts](std::int64_t, std::int64_t) { interrupts.check(); };
  return std::forward<Compute>(compute)(options);
}

/// Returns an array (nx, ny, nz) that owns `values`, which have x fastest.
template <class Element, class Value>
py::array as_array(std::vector<Value> values, const GridIndex& size) {
  static_assert(sizeof(Element) == sizeof(Value));
  auto list = std::make_unique<std::vector<Value>>(std::move(values));
  const Value* const first = list->data();
  const py::capsule owner(list.get(),
                          [](void* memory) { delete static_cast<std::vector<Value>*>(memory); });
  static_cast<void>(list.release());  // the capsule deletes it
  constexpr std::int64_t step = sizeof(Value);
  return {py::dtype::of<Element>(),
          {size[0], size[1], size[2]},
          {step, step * size[0], step * size[0] * size[1]},
          first,
          owner};
}

py::tuple dielectric_of(const ComputedResult& result, double solute, double solvent) {
  std::array<std::vector<double>, 3> maps = compute_map(result, [&](const RunOptions& options) {
    return compute_dielectric(result.surface, result.grid(), {solute, solvent}, options);
  });
  py::tuple arrays(3);
  for (std::size_t axis = 0; axis < 3; ++axis)
    arrays[axis] = as_array<double>(std::move(maps[axis]), result.region().size());
  return arrays;
}

py::array kappa_of(const ComputedResult& result, double ion_radius) {
  std::vector<std::uint8_t> access = compute_map(result, [&](const RunOptions& options) {
    return compute_ion_access(result.surface, result.grid(), ion_radius, options);
  });
  return as_array<bool>(std::move(access), result.region().size());
}

}  // namespace

void bind_solver_maps(py::class_<ComputedResult, std::shared_ptr<ComputedResult>>& result) {
  result
      .def("dielectric", &dielectric_of, dielectric_text,
           py::arg("solute") = DielectricOptions().solute,
           py::arg("solvent") = DielectricOptions().solvent)
      .def("kappa", &kappa_of, kappa_text, py::arg("ion_radius") = IonAccessMap().ion_radius);
}

}  // namespace eses::python
