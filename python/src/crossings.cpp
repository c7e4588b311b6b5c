#include "crossings.hpp"

#include <cstdint>

#include "arrays.hpp"

namespace eses::python {
namespace {

constexpr const char* class_text =
    R"(Crossings of grid edges with the surface, as arrays of M values.

A crossing belongs to a grid edge that has one end inside the surface and one outside. If the surface
cuts an edge several times, it is the crossing that is nearest to the outside end. The order is that
of the lower ends (z, then y, then x), and then of the axis.

All arrays are read-only. Copy an array to change it or to make it contiguous.)";

// An empty list has no first element, but a view of no values still needs an address.
const Crossing& first_of(std::span<const Crossing> list) {
  static const Crossing placeholder;
  return list.empty() ? placeholder : list.front();
}

// Returns one field of all crossings as an array.
template <class Member>
py::array view(const py::object& self, Member Crossing::*member) {
  const std::span<const Crossing> list = self.cast<const Crossings&>().list();
  return field_view(&(first_of(list).*member), list.size(), sizeof(Crossing), self);
}

py::array vectors(const py::object& self, Vec3 Crossing::*member) {
  const std::span<const Crossing> list = self.cast<const Crossings&>().list();
  return field_view(&(first_of(list).*member).x, list.size(), sizeof(Crossing), self, 3);
}

py::array lower_ends(const py::object& self) {
  const std::span<const Crossing> list = self.cast<const Crossings&>().list();
  return field_view(first_of(list).lower.data(), list.size(), sizeof(Crossing), self, 3);
}

// Runs the signal handlers of Python now and then during a loop over crossings, of which hundreds
// of millions take seconds. The caller has the interpreter's lock.
void check_signals(std::size_t index) {
  constexpr std::size_t crossings_between_checks = std::size_t{1} << 18;
  if (index % crossings_between_checks == 0 && PyErr_CheckSignals() != 0)
    throw py::error_already_set();
}

py::array_t<std::int64_t> ends(const Crossings& crossings, GridIndex (Crossing::*end)() const) {
  const std::span<const Crossing> list = crossings.list();
  py::array_t<std::int64_t> points({list.size(), std::size_t{3}});
  auto values = points.mutable_unchecked<2>();
  for (std::size_t i = 0; i < list.size(); ++i) {
    check_signals(i);
    const GridIndex point = (list[i].*end)();
    for (std::size_t axis = 0; axis < 3; ++axis)
      values(static_cast<py::ssize_t>(i), static_cast<py::ssize_t>(axis)) = point[axis];
  }
  return points;
}

}  // namespace

py::array Crossings::atoms() {
  if (!atoms_) {
    py::array_t<std::int64_t> atoms({list_.size(), std::size_t{3}});
    std::int64_t* next = atoms.mutable_data();
    for (std::size_t i = 0; i < list_.size(); ++i) {
      check_signals(i);
      const Crossing& crossing = list_[i];
      for (std::size_t q = 0; q < 3; ++q)
        *next++ = q < crossing.atom_count ? std::int64_t{crossing.atoms[q]} : -1;
    }
    atoms.attr("setflags")(py::arg("write") = false);
    atoms_ = std::move(atoms);
  }
  return *atoms_;
}

void bind_crossings(py::module_& module) {
  py::class_<Crossings> type(module, "Crossings", class_text);
  type.attr("__module__") = "eses";
  type.def("__len__", [](const Crossings& self) { return self.list().size(); })
      .def("__repr__",
           [](const Crossings& self) {
             return "<eses.Crossings: " + std::to_string(self.list().size()) + " crossings>";
           })
      .def_property_readonly("lower", &lower_ends,
                             "(M, 3) int64: lower ends of the edges, as indices in the whole grid.")
      .def_property_readonly(
          "axis", [](const py::object& self) { return view(self, &Crossing::axis); },
          "(M,) uint8: directions of the edges, 0, 1, 2 for x, y, z.")
      .def_property_readonly(
          "position", [](const py::object& self) { return vectors(self, &Crossing::position); },
          "(M, 3) float64: positions of the crossings, in angstrom.")
      .def_property_readonly(
          "normal", [](const py::object& self) { return vectors(self, &Crossing::normal); },
          "(M, 3) float64: outward unit normals of the surface.")
      .def_property_readonly("atoms", &Crossings::atoms,
                             "(M, 3) int64: indices of the adjacent atoms, ascending, and -1 where "
                             "there is none.\n\nThe array is made when it is first needed.")
      .def_property_readonly(
          "kind", [](const py::object& self) { return view(self, &Crossing::atom_count); },
          "(M,) uint8: kinds of the patches, 1 convex, 2 saddle, 3 concave.\n\nThe kind is also "
          "the "
          "number of adjacent atoms.")
      .def_property_readonly(
          "lower_is_inside",
          [](const py::object& self) { return view(self, &Crossing::lower_is_inside); },
          "(M,) bool: whether the lower end of the edge is the inside one.")
      .def_property_readonly(
          "inside_point", [](const Crossings& self) { return ends(self, &Crossing::inside_point); },
          "(M, 3) int64: the ends that are inside, as indices in the whole grid; a new array.")
      .def_property_readonly(
          "outside_point",
          [](const Crossings& self) { return ends(self, &Crossing::outside_point); },
          "(M, 3) int64: the ends that are outside, as indices in the whole grid; a new array.");
}

}  // namespace eses::python
