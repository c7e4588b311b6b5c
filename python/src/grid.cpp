#include "grid.hpp"

#include <pybind11/stl.h>

#include <eses/eses.hpp>
#include <filesystem>
#include <string>
#include <tuple>

#include "arrays.hpp"
#include "instances.hpp"
#include "read_file.hpp"

namespace eses::python {
namespace {

constexpr const char* class_text = R"(Cartesian grid with the same spacing along all axes.

Point ``(i, j, k)`` is at ``origin + (i, j, k) * spacing``. Arrays over the grid have the shape
``(nx, ny, nz)``. A grid never changes.

Parameters
----------
origin : sequence of 3 floats
    Position of point (0, 0, 0), in angstrom.
spacing : float
    Distance between neighbouring points, in angstrom.
shape : sequence of 3 ints
    Number of points along x, y and z.

Raises
------
ValueError
    If the spacing is not positive, a number is not finite, or if there are fewer than one or more
    than 2e9 points along an axis, or more than 1e17 in all.)";

constexpr const char* init_text = R"(__init__(self, origin, spacing, shape)
--

Check the grid.)";

constexpr const char* coordinates_text = R"(coordinates(self, axis)
--

Return the coordinates of the points along an axis.

Parameters
----------
axis : int
    0, 1 or 2 for x, y or z.

Returns
-------
numpy.ndarray
    (n,) float64, in angstrom; a new array, which may be changed.)";

constexpr const char* read_text = R"(read_grid(path)
--

Read the grid of a file.

Parameters
----------
path : str, bytes or os.PathLike
    Name of an OpenDX map (``.dx``), of VTK image data (``.vti``) or of ``bounding_box.txt``, each of
    which may be gzipped. Of a map only the header is read.

Returns
-------
Grid
    The grid, which has the same spacing along all axes.

Raises
------
OSError
    If the file cannot be opened or read.
ValueError
    If the file has no such grid. The message names the file and the line.)";

Grid read(const py::object& file) {
  const std::filesystem::path path = path_of(file);
  return read_file_as_value([&] { return read_grid(path); });
}

Grid make(const Triple& origin, double spacing, const GridIndex& shape) {
  const Grid grid{as_vector(origin), spacing, shape};
  validate(grid);
  return grid;
}

py::array_t<double> coordinates(const Grid& grid, std::size_t axis) {
  if (axis > 2) throw py::value_error("axis must be 0, 1 or 2, not " + std::to_string(axis));
  auto values = make_array<double>(grid.size[axis]);
  auto value = values.mutable_unchecked<1>();
  for (std::int64_t i = 0; i < grid.size[axis]; ++i) value(i) = grid.coordinate(axis, i);
  return values;
}

py::tuple origin_of(const Grid& grid) {
  return py::make_tuple(grid.origin.x, grid.origin.y, grid.origin.z);
}

py::str text_of(const Grid& grid) {
  return py::str("eses_blocks.Grid(origin={}, spacing={}, shape={})")
      .format(origin_of(grid), grid.spacing, as_tuple(grid.size));
}

bool are_equal(const Grid& a, const Grid& b) {
  return a.origin == b.origin && a.spacing == b.spacing && a.size == b.size;
}

}  // namespace

void bind_grid(py::module_& module) {
  py::class_<Grid> type(module, "Grid", class_text);
  type.attr("__module__") = "eses_blocks";
  type.def(py::init(&make), init_text, py::arg("origin"), py::arg("spacing"), py::arg("shape"))
      .def_property_readonly("origin", &origin_of,
                             "tuple of 3 floats: position of point (0, 0, 0), in angstrom.")
      .def_property_readonly(
          "spacing", [](const Grid& self) { return self.spacing; },
          "float: distance between neighbouring points, in angstrom.")
      .def_property_readonly(
          "shape", [](const Grid& self) { return as_tuple(self.size); },
          "tuple of 3 ints: number of points along x, y and z.")
      .def_property_readonly(
          "size", [](const Grid& self) { return self.point_count(); }, "int: number of points.")
      .def("coordinates", &coordinates, coordinates_text, py::arg("axis"))
      .def("__eq__",
           [](const Grid& self, const py::object& other) -> py::object {
             if (!py::isinstance<Grid>(other))
               return py::reinterpret_borrow<py::object>(Py_NotImplemented);
             return py::bool_(are_equal(self, other.cast<const Grid&>()));
           })
      .def("__hash__",
           [](const Grid& self) {
             return py::hash(py::make_tuple(origin_of(self), self.spacing, as_tuple(self.size)));
           })
      .def("__repr__", &text_of)
      .def(py::pickle(
          [](const Grid& self) {
            return py::make_tuple(origin_of(self), self.spacing, as_tuple(self.size));
          },
          [](const py::tuple& state) {
            return std::apply(make, unpack_state<std::tuple<Triple, double, GridIndex>>(state));
          }));
  protect_instances(type);
  module.def("read_grid", &read, read_text, py::arg("path"));
}

}  // namespace eses::python
