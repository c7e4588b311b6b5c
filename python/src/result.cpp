#include "result.hpp"

#include <algorithm>
#include <cstdint>
#include <eses/eses.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "computed_result.hpp"
#include "crossings.hpp"
#include "instances.hpp"
#include "interrupts.hpp"
#include "run_arguments.hpp"
#include "solver_maps.hpp"

namespace eses::python {
namespace {

constexpr const char* result_text = R"(The surface on a grid.

All arrays are read-only and share their memory with the result. Copy an array to change it.)";

constexpr const char* volume_text =
    R"(float: enclosed volume by the formula of ESES, in cubic angstrom.

Use it to compare with ESES, whose volume it is. It counts a point that ends a crossed edge as half,
so that it converges slowly with the spacing. ``divergence_volume`` is more accurate.)";

constexpr const char* divergence_volume_text =
    R"(float: enclosed volume by the divergence theorem, in cubic angstrom.

Use it for all other purposes. It takes the positions of the crossings into account and is of second
order in the spacing. ``volume`` is the one that ESES prints.)";

constexpr const char* inside_text = R"((nx, ny, nz) bool: whether each point is inside the surface.

The shape is that of the grid, or of the region if one was chosen. The array is a view in Fortran
order (x fastest). Raises ValueError if the surface was computed with ``inside=False``.)";

constexpr const char* crossings_text = R"(Crossings: crossings of grid edges with the surface.

With a region, the crossings are those of the edges whose lower ends are in it. Raises ValueError if
the surface was computed with ``crossings=False``.)";

constexpr const char* mesh_text = R"(mesh(self, *, quality=False, component=False)
--

Make a triangle mesh of the surface.

The mesh covers the cells of the grid that have all their corners in the region, and has one vertex
for each crossing of an edge with both ends in the region. With a region it is open and ends one cell
before the mesh that ``eses-blocks --mesh --region`` writes.

Parameters
----------
quality : bool, default False
    Improve the triangles, as ``eses-blocks --mesh-quality`` does. The vertices are then some of the
    crossings, in the same order.
component : bool, default False
    Find the components of the vertices, ``Mesh.component``.

Returns
-------
Mesh
    Vertices, normals and faces.

Raises
------
ValueError
    If the surface was computed with ``inside=False`` or ``crossings=False``.
MemoryError
    If the mesh does not fit into memory.)";

constexpr const char* mesh_class_text = R"(Triangle mesh of a surface, with V vertices and F faces.

The vertices are in the order of the crossings. A vertex is at its crossing, or 1e-4 of the spacing
away from a grid point with which the crossing coincides. All arrays are read-only and share their
memory with the mesh.)";

using InsideArray = py::array_t<bool, py::array::f_style | py::array::forcecast>;

std::shared_ptr<Mesh> mesh_of(const ComputedResult& result, bool quality, bool component) {
  if (!result.parts().inside || !result.parts().crossings)
    throw py::value_error(
        "a mesh needs the inside points and the crossings, which were not both chosen; compute "
        "with inside=True and crossings=True");
  const py::gil_scoped_release unlocked;
  Interrupts interrupts;
  const auto check = [&interrupts] { interrupts.check(); };
  const auto make = [&](const auto&... arguments) {
    return std::make_shared<Mesh>(quality ? make_quality_mesh(result, arguments...)
                                          : make_mesh(result, arguments...));
  };
  return component ? make(result.surface, check) : make(check);
}

py::array inside_of(const py::object& self) {
  const auto& result = self.cast<const ComputedResult&>();
  if (!result.parts().inside)
    throw py::value_error("the inside points were not chosen; compute with inside=True");
  return inside_view(result.inside(), result.region().size(), self);
}

Crossings crossings_of(const std::shared_ptr<ComputedResult>& result) {
  if (!result->parts().crossings)
    throw py::value_error("the crossings were not chosen; compute with crossings=True");
  return {result, result->crossings()};
}

py::array atom_areas_of(const py::object& self) {
  const std::span<const double> areas = self.cast<const ComputedResult&>().atom_areas();
  return field_view(areas.data(), areas.size(), sizeof(double), self);
}

// The totals of a result in the order of a state. The times are left out.
auto totals_of(const Summary& summary) {
  return std::tuple(summary.area, summary.volume, summary.divergence_volume, summary.inside_points,
                    summary.convex, summary.saddle, summary.concave, summary.convex_area,
                    summary.saddle_area, summary.concave_area);
}
using Totals = decltype(totals_of({}));

Summary summary_of(const Totals& totals, const StateArray<double>& atom_areas) {
  Summary summary;
  std::tie(summary.area, summary.volume, summary.divergence_volume, summary.inside_points,
           summary.convex, summary.saddle, summary.concave, summary.convex_area,
           summary.saddle_area, summary.concave_area) = totals;
  summary.atom_areas.assign(atom_areas.data(), atom_areas.data() + atom_areas.size());
  return summary;
}

py::tuple result_state(const py::object& self) {
  const auto& result = self.cast<const ComputedResult&>();
  const py::object none = py::none();
  return py::make_tuple(
      result.surface, result.grid(), self.attr("region"), result.options.threads,
      result.options.block_size, result.options.max_memory, totals_of(result.summary()),
      self.attr("atom_areas"), result.parts().inside ? py::object(self.attr("inside")) : none,
      result.parts().crossings ? py::object(crossing_state(self.attr("crossings"))) : none);
}

// Returns the values of points in the order of Result::inside.
std::vector<std::uint8_t> inside_of_state(const InsideArray& inside, const GridRegion& region) {
  const GridIndex size = region.size();
  if (inside.ndim() != 3 || !std::equal(size.begin(), size.end(), inside.shape()))
    throw py::value_error("the inside points of the state have the wrong shape");
  const auto* const first = reinterpret_cast<const std::uint8_t*>(inside.data());
  return {first, first + inside.size()};
}

std::shared_ptr<ComputedResult> result_of_state(const py::tuple& state) {
  const auto [surface, grid, range, threads, block_size, max_memory, totals, atom_areas, inside,
              crossings] =
      unpack_state<
          std::tuple<ChosenSurface, Grid, IndexCorners, int, std::int64_t, std::uint64_t, Totals,
                     StateArray<double>, std::optional<InsideArray>, std::optional<py::tuple>>>(
          state);
  require_shape(atom_areas, surface.atoms().size());
  const RunOptions options = make_options(grid, {{threads}, block_size, {}, range, max_memory});
  const GridRegion region = *options.region;
  std::optional<std::vector<std::uint8_t>> points;
  if (inside) points = inside_of_state(*inside, region);
  std::optional<std::vector<Crossing>> list;
  if (crossings) list = crossings_of_state(*crossings);
  return std::make_shared<ComputedResult>(
      Result(summary_of(totals, atom_areas), grid, region, std::move(points), std::move(list)),
      surface, options);
}

py::tuple mesh_state(const py::object& mesh) {
  return py::make_tuple(mesh.attr("vertices"), mesh.attr("normals"), mesh.attr("atoms"),
                        mesh.attr("kind"), mesh.attr("faces"), mesh.attr("component"));
}

std::vector<Vec3> vectors_of_state(const StateArray<double>& values, std::size_t count) {
  require_shape(values, count, 3);
  std::vector<Vec3> vectors(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double* const value = values.data() + 3 * i;
    vectors[i] = {value[0], value[1], value[2]};
  }
  return vectors;
}

std::shared_ptr<Mesh> mesh_of_state(const py::tuple& state) {
  const auto [vertices, normals, atoms, kind, faces, component] =
      unpack_state<std::tuple<StateArray<double>, StateArray<double>, StateArray<AtomIndex>,
                              StateArray<std::uint8_t>, StateArray<std::uint64_t>,
                              std::optional<StateArray<std::uint32_t>>>>(state);
  const auto count = static_cast<std::size_t>(atoms.size());
  const auto face_count = static_cast<std::size_t>(faces.size() / 3);
  require_shape(atoms, count);
  require_shape(kind, count);
  require_shape(faces, face_count, 3);
  if (component) require_shape(*component, count);
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices = vectors_of_state(vertices, count);
  mesh->normals = vectors_of_state(normals, count);
  mesh->atoms.assign(atoms.data(), atoms.data() + count);
  mesh->patches.assign(kind.data(), kind.data() + count);
  if (component) mesh->components.assign(component->data(), component->data() + count);
  mesh->faces.resize(face_count);
  for (std::size_t i = 0; i < 3 * face_count; ++i) {
    if (faces.data()[i] >= count)
      throw py::value_error("a face of the state has a vertex that does not exist");
    mesh->faces[i / 3][i % 3] = faces.data()[i];
  }
  return mesh;
}

py::str text_of(const ComputedResult& result) {
  return py::str("<eses_blocks.Result: area {:.6g}, volume {:.6g}>")
      .format(result.area(), result.volume());
}

void bind_mesh(py::module_& module) {
  py::class_<Mesh, std::shared_ptr<Mesh>> type(module, "Mesh", mesh_class_text);
  type.attr("__module__") = "eses_blocks";
  const auto vectors = [](std::vector<Vec3> Mesh::*member) {
    return [member](const py::object& self) {
      const std::vector<Vec3>& list = self.cast<const Mesh&>().*member;
      return field_view(reinterpret_cast<const double*>(list.data()), list.size(), sizeof(Vec3),
                        self, 3);
    };
  };
  type.def_property_readonly("vertices", vectors(&Mesh::vertices),
                             "(V, 3) float64: positions of the vertices, in angstrom.")
      .def_property_readonly("normals", vectors(&Mesh::normals),
                             "(V, 3) float64: outward unit normals of the vertices.")
      .def_property_readonly(
          "faces",
          [](const py::object& self) {
            const auto& faces = self.cast<const Mesh&>().faces;
            // No index reaches 2^63, and most libraries expect signed indices.
            return field_view(reinterpret_cast<const std::int64_t*>(faces.data()), faces.size(),
                              sizeof(faces[0]), self, 3);
          },
          "(F, 3) int64: indices of the vertices of each triangle, counterclockwise seen from "
          "outside.")
      .def_property_readonly(
          "atoms",
          [](const py::object& self) {
            const auto& atoms = self.cast<const Mesh&>().atoms;
            return field_view(atoms.data(), atoms.size(), sizeof(AtomIndex), self);
          },
          "(V,) uint32: first adjacent atom of each vertex.")
      .def_property_readonly(
          "kind",
          [](const py::object& self) {
            const auto& patches = self.cast<const Mesh&>().patches;
            return field_view(patches.data(), patches.size(), 1, self);
          },
          "(V,) uint8: kinds of the patches, 1 convex, 2 saddle, 3 concave.")
      .def_property_readonly(
          "component",
          [](const py::object& self) -> py::object {
            const auto& components = self.cast<const Mesh&>().components;
            if (components.empty()) return py::none();
            return field_view(components.data(), components.size(), sizeof(std::uint32_t), self);
          },
          "(V,) uint32, or None: component of each vertex, 0 outside, otherwise the number of the "
          "cavity from 1; see ``Result.mesh``.")
      .def("__repr__",
           [](const Mesh& self) {
             return "<eses_blocks.Mesh: " + std::to_string(self.vertices.size()) + " vertices, " +
                    std::to_string(self.faces.size()) + " faces>";
           })
      .def(py::pickle(&mesh_state, &mesh_of_state));
  protect_instances(type);
}

// Defines a property for one number of the summary.
template <class Value>
auto total(Value Summary::*member) {
  return [member](const ComputedResult& result) { return result.summary().*member; };
}

}  // namespace

void bind_result(py::module_& module) {
  bind_mesh(module);
  py::class_<ComputedResult, std::shared_ptr<ComputedResult>> type(module, "Result", result_text);
  type.attr("__module__") = "eses_blocks";
  type.def_property_readonly("area", &ComputedResult::area,
                             "float: area of the surface, in square angstrom.")
      .def_property_readonly("volume", &ComputedResult::volume, volume_text)
      .def_property_readonly("divergence_volume", total(&Summary::divergence_volume),
                             divergence_volume_text)
      .def_property_readonly("atom_areas", &atom_areas_of,
                             "(N,) float64: share of each atom in the area, in square angstrom.")
      .def_property_readonly("convex_area", total(&Summary::convex_area),
                             "float: area of the convex patches, in square angstrom.")
      .def_property_readonly("saddle_area", total(&Summary::saddle_area),
                             "float: area of the saddle patches, in square angstrom.")
      .def_property_readonly("concave_area", total(&Summary::concave_area),
                             "float: area of the concave patches, in square angstrom.")
      .def_property_readonly("inside_points", total(&Summary::inside_points),
                             "int: number of points inside the surface.")
      .def_property_readonly(
          "grid", [](const ComputedResult& self) { return self.grid(); },
          "Grid: the grid that was passed to ``compute``.")
      .def_property_readonly(
          "region", [](const ComputedResult& self) { return as_tuple(self.region()); },
          "tuple of 2 index triples: first point, and one more than the last point along each "
          "axis.")
      .def_property_readonly("inside", &inside_of, inside_text)
      .def_property_readonly("crossings", &crossings_of, crossings_text)
      .def("mesh", &mesh_of, py::kw_only(), py::arg("quality") = false,
           py::arg("component") = false, mesh_text)
      .def("__repr__", &text_of)
      .def(py::pickle(&result_state, &result_of_state));
  protect_instances(type);
  bind_solver_maps(type);
  module.def("_spheres_of", [](const py::object& result) {
    const auto atoms = result.cast<const ComputedResult&>().surface.atoms();
    return py::make_tuple(centers_view(atoms, result), radii_view(atoms, result));
  });
}

}  // namespace eses::python
