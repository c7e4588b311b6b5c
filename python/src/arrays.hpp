#pragma once
/// Conversion between numpy arrays and the types of the library.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <eses/eses.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eses::python {

namespace py = pybind11;

/// Three numbers as Python passes them.
using Triple = std::array<double, 3>;

/// Makes a vector from three numbers.
inline Vec3 as_vector(const Triple& values) { return {values[0], values[1], values[2]}; }

/// The two corners of a range of points or blocks. The second corner is not included.
using IndexCorners = std::array<GridIndex, 2>;

/// Makes an array of `count` values. The constructor of pybind11 before 2.12 that takes a count
/// makes all strides 0 with numpy 2. The one that takes a shape does not.
template <class Value>
py::array_t<Value> make_array(py::ssize_t count) {
  return py::array_t<Value>(py::array::ShapeContainer{count});
}

/// Returns the rows of a field of structs as a read-only array that shares their memory and keeps
/// `owner` alive. `first` is the field of the first of `count` structs that are `stride` bytes
/// apart. A field with several values becomes a row of `columns` values.
template <class Value>
py::array field_view(const Value* first, std::size_t count, std::size_t stride, py::handle owner,
                     std::size_t columns = 0) {
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(count)};
  std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(stride)};
  if (columns > 0) {
    shape.push_back(static_cast<py::ssize_t>(columns));
    strides.push_back(sizeof(Value));
  }
  py::array view(py::dtype::of<Value>(), std::move(shape), std::move(strides), first, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

/// Returns a read-only array (nx, ny, nz) of bool that shares the memory of `inside`, which has a
/// byte for each point, x fastest. It keeps `owner` alive.
py::array inside_view(std::span<const std::uint8_t> inside, const GridIndex& size,
                      py::handle owner);

/// Returns the shape of an array as text for messages.
std::string shape_text(const py::array& array);

/// Returns values as an array of any real type. Raises TypeError for other types, and ValueError
/// for masked entries. `name` is the name of the argument.
py::array real_array(const py::object& values, const std::string& name);

/// Converts an array to one of doubles.
py::array_t<double> as_doubles(const py::array& array);

/// Makes a list from an array of shape (count,) with a value for each atom. Raises TypeError and
/// ValueError. `name` is the name of the argument.
std::vector<double> make_atom_values(const py::object& values, const std::string& name,
                                     std::size_t count);

/// Makes atoms from arrays of shape (N, 3) and (N,), of any real type and memory layout. Raises
/// TypeError and ValueError.
std::vector<Atom> make_atoms(const py::object& centers, const py::object& radii);

/// Returns the centres (N, 3) of atoms as a view that keeps `owner` alive.
py::array centers_view(std::span<const Atom> atoms, py::handle owner);

/// Returns the radii (N,) of atoms as a view that keeps `owner` alive.
py::array radii_view(std::span<const Atom> atoms, py::handle owner);

/// Makes a tuple of three integers.
py::tuple as_tuple(const GridIndex& index);

/// Makes a tuple of the two corners of a region.
py::tuple as_tuple(const GridRegion& region);

}  // namespace eses::python
