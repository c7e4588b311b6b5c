#include "arrays.hpp"

#include <string>

namespace eses::python {

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis)
    text += (axis > 0 ? ", " : "") + std::to_string(array.shape(axis));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

namespace {

// Whether values are a table or a column of pandas whose types are real numbers. numpy makes arrays
// of objects from the types that have missing values, such as Float64.
bool is_real_frame(const py::object& values) {
  if (!py::hasattr(values, "to_numpy") || !py::hasattr(values, "dtypes")) return false;
  const py::object types = values.attr("dtypes");
  const py::list list =
      py::hasattr(types, "kind") ? py::list(py::make_tuple(types)) : py::list(types);
  for (const py::handle type : list) {
    const auto kind = py::str(py::getattr(type, "kind", py::str(""))).cast<std::string>();
    if (kind != "f" && kind != "i" && kind != "u") return false;
  }
  return true;
}

// Returns numpy.asarray(values). Raises ValueError with the name for lists of different lengths.
py::array as_array(const py::object& values, const std::string& name) {
  try {
    return py::module_::import("numpy").attr("asarray")(values).cast<py::array>();
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError)) throw;
    const std::string text =
        name + " is no array of numbers: " + py::str(error.value()).cast<std::string>();
    py::raise_from(error, PyExc_ValueError, text.c_str());
    throw py::error_already_set();
  }
}

}  // namespace

py::array real_array(const py::object& values, const std::string& name) {
  const auto numpy = py::module_::import("numpy");
  if (numpy.attr("ma").attr("is_masked")(values).cast<bool>())
    throw py::value_error(name + " has masked entries; leave these atoms out of both arrays");
  const py::array array = is_real_frame(values)
                              ? values.attr("to_numpy")("float64").cast<py::array>()
                              : as_array(values, name);
  // asarray makes an array of floats from an empty list, so an empty list passes this check.
  if (const char kind = array.dtype().kind(); kind != 'f' && kind != 'i' && kind != 'u')
    throw py::type_error(name + " must be an array of real numbers, not of type " +
                         py::str(array.dtype()).cast<std::string>());
  return array;
}

py::array_t<double> as_doubles(const py::array& array) {
  auto numbers = py::array_t<double, py::array::forcecast>::ensure(array);
  if (!numbers) throw py::error_already_set();
  return py::reinterpret_steal<py::array_t<double>>(numbers.release());
}

std::vector<double> make_atom_values(const py::object& values, const std::string& name,
                                     std::size_t count) {
  const py::array_t<double> array = as_doubles(real_array(values, name));
  if (array.ndim() != 1 || static_cast<std::size_t>(array.shape(0)) != count)
    throw py::value_error(name + " must have shape (" + std::to_string(count) +
                          ",), one for each of the centers, not " + shape_text(array));
  const auto value = array.unchecked<1>();
  std::vector<double> list(count);
  for (std::size_t i = 0; i < count; ++i) list[i] = value(static_cast<py::ssize_t>(i));
  return list;
}

py::array inside_view(std::span<const std::uint8_t> inside, const GridIndex& size,
                      py::handle owner) {
  static_assert(sizeof(bool) == 1);
  py::array view(py::dtype::of<bool>(), {size[0], size[1], size[2]},
                 {std::int64_t{1}, size[0], size[0] * size[1]}, inside.data(), owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

std::vector<Atom> make_atoms(const py::object& centers, const py::object& radii) {
  const py::array_t<double> center_array = as_doubles(real_array(centers, "centers"));
  const py::array radius_array = real_array(radii, "radii");
  if (center_array.ndim() != 2 || center_array.shape(1) != 3)
    throw py::value_error("centers must have shape (N, 3), not " + shape_text(center_array));
  const std::vector<double> radius =
      make_atom_values(radius_array, "radii", static_cast<std::size_t>(center_array.shape(0)));
  const auto center = center_array.unchecked<2>();
  std::vector<Atom> atoms;
  atoms.reserve(radius.size());
  for (const double value : radius) {
    const auto i = static_cast<py::ssize_t>(atoms.size());
    atoms.push_back({{center(i, 0), center(i, 1), center(i, 2)}, value});
  }
  return atoms;
}

py::array centers_view(std::span<const Atom> atoms, py::handle owner) {
  return field_view(&atoms.data()->center.x, atoms.size(), sizeof(Atom), owner, 3);
}

py::array radii_view(std::span<const Atom> atoms, py::handle owner) {
  return field_view(&atoms.data()->radius, atoms.size(), sizeof(Atom), owner);
}

py::tuple as_tuple(const GridIndex& index) { return py::make_tuple(index[0], index[1], index[2]); }

py::tuple as_tuple(const GridRegion& region) {
  return py::make_tuple(as_tuple(region.begin), as_tuple(region.end));
}

}  // namespace eses::python
