#include "crossings.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "instances.hpp"
#include "measure_records.hpp"

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

std::span<const std::int64_t> Crossings::atoms() {
  if (!atoms_) {
    std::vector<std::int64_t> atoms;
    atoms.reserve(3 * list_.size());
    for (std::size_t i = 0; i < list_.size(); ++i) {
      check_signals(i);
      const Crossing& crossing = list_[i];
      for (std::size_t q = 0; q < 3; ++q)
        atoms.push_back(q < crossing.atom_count ? std::int64_t{crossing.atoms[q]} : -1);
    }
    // A signal handler may have called this function, and arrays may share the memory of its list.
    if (!atoms_) atoms_ = std::move(atoms);
  }
  return *atoms_;
}

py::tuple crossing_state(const py::object& crossings) {
  return py::make_tuple(crossings.attr("lower"), crossings.attr("axis"), crossings.attr("position"),
                        crossings.attr("normal"), crossings.attr("atoms"), crossings.attr("kind"),
                        crossings.attr("lower_is_inside"));
}

std::vector<Crossing> crossings_of_state(const py::tuple& state) {
  const auto [lower, axis, position, normal, atoms, kind, lower_is_inside] =
      unpack_state<std::tuple<StateArray<std::int64_t>, StateArray<std::uint8_t>,
                              StateArray<double>, StateArray<double>, StateArray<std::int64_t>,
                              StateArray<std::uint8_t>, StateArray<bool>>>(state);
  const auto count = static_cast<std::size_t>(axis.size());
  for (const py::array& vectors :
       {py::array(lower), py::array(position), py::array(normal), py::array(atoms)})
    require_shape(vectors, count, 3);
  for (const py::array& values : {py::array(axis), py::array(kind), py::array(lower_is_inside)})
    require_shape(values, count);
  std::vector<Crossing> crossings(count);
  for (std::size_t i = 0; i < count; ++i) {
    check_signals(i);
    Crossing& crossing = crossings[i];
    const std::int64_t* const point = lower.data() + 3 * i;
    const double* const place = position.data() + 3 * i;
    const double* const direction = normal.data() + 3 * i;
    const std::int64_t* const adjacent = atoms.data() + 3 * i;
    crossing.lower = {point[0], point[1], point[2]};
    crossing.position = {place[0], place[1], place[2]};
    crossing.normal = {direction[0], direction[1], direction[2]};
    crossing.axis = axis.data()[i];
    crossing.atom_count = kind.data()[i];
    crossing.lower_is_inside = lower_is_inside.data()[i];
    if (crossing.axis > 2 || crossing.atom_count < 1 || crossing.atom_count > 3 ||
        *std::min_element(point, point + 3) < 0 ||
        *std::max_element(point, point + 3) > std::numeric_limits<std::uint32_t>::max())
      throw py::value_error("a crossing of the state has an invalid edge or kind");
    for (std::size_t q = 0; q < crossing.atom_count; ++q) {
      if (adjacent[q] < 0 || adjacent[q] >= std::numeric_limits<AtomIndex>::max())
        throw py::value_error("a crossing of the state has an invalid atom");
      crossing.atoms[q] = static_cast<AtomIndex>(adjacent[q]);
    }
  }
  return crossings;
}

void bind_crossings(py::module_& module) {
  py::class_<Crossings> type(module, "Crossings", class_text);
  type.attr("__module__") = "eses_blocks";
  type.def("__len__", [](const Crossings& self) { return self.list().size(); })
      .def("__repr__",
           [](const Crossings& self) {
             return "<eses_blocks.Crossings: " + std::to_string(self.list().size()) + " crossings>";
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
      .def_property_readonly(
          "atoms",
          [](const py::object& self) {
            const std::span<const std::int64_t> atoms = self.cast<Crossings&>().atoms();
            return field_view(atoms.data(), atoms.size() / 3, 3 * sizeof(atoms[0]), self, 3);
          },
          "(M, 3) int64: indices of the adjacent atoms, ascending, and -1 where there is none.\n\n"
          "The values are made when they are first needed.")
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
          "inside_point",
          [](const Crossings& self) { return read_only(ends(self, &Crossing::inside_point)); },
          "(M, 3) int64: the ends that are inside, as indices in the whole grid; a new array.")
      .def_property_readonly(
          "outside_point",
          [](const Crossings& self) { return read_only(ends(self, &Crossing::outside_point)); },
          "(M, 3) int64: the ends that are outside, as indices in the whole grid; a new array.")
      .def(py::pickle(&crossing_state, [](const py::tuple& state) {
        const auto list = std::make_shared<const std::vector<Crossing>>(crossings_of_state(state));
        return Crossings(list, *list);
      }));
  protect_instances(type);
}

}  // namespace eses::python
