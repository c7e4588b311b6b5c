#include "blocks.hpp"

#include <memory>
#include <span>
#include <stdexcept>

#include "arrays.hpp"
#include "block_stream.hpp"
#include "crossings.hpp"
#include "instances.hpp"
#include "interrupts.hpp"

namespace eses::python {
namespace {

constexpr const char* block_text = R"(Part of the grid that has been solved.

Each point and each crossing of the grid belongs to exactly one block. All arrays are read-only and
share their memory with the block.)";

constexpr const char* iterator_text = R"(Iterator over the blocks of a grid, in no particular order.

Other threads compute the blocks, at most a few ahead of the loop.
The iterator is also a context manager that calls ``close`` at its end.)";

constexpr const char* close_text = R"(close(self)
--

End the computation and drop the remaining blocks.

A deleted iterator does so as well, for example after a loop that was left early.)";

std::shared_ptr<BlockCopy> next_block(BlockStream& stream) {
  std::shared_ptr<BlockCopy> block;
  {
    const py::gil_scoped_release unlocked;
    Interrupts interrupts;
    try {
      block = stream.next([&interrupts] { interrupts.check(); });
    } catch (...) {
      stream.close();
      throw;
    }
  }
  if (!block) throw py::stop_iteration();
  return block;
}

const Summary& summary_of(const BlockStream& stream) {
  const Summary* const summary = stream.summary();
  if (summary == nullptr)
    throw std::runtime_error("the totals are known after the last block; finish the loop first");
  return *summary;
}

py::tuple slices_of(const BlockCopy& block) {
  py::tuple slices(3);
  for (std::size_t axis = 0; axis < 3; ++axis)
    slices[axis] = py::slice(static_cast<py::ssize_t>(block.owned.begin[axis]),
                             static_cast<py::ssize_t>(block.owned.end[axis]), 1);
  return slices;
}

void bind_block(py::module_& module) {
  py::class_<BlockCopy, std::shared_ptr<BlockCopy>> type(module, "Block", block_text);
  type.attr("__module__") = "eses_blocks";
  type.def("__repr__",
           [](const BlockCopy& self) {
             return py::str("<eses_blocks.Block: points {} to {}, {} crossings>")
                 .format(as_tuple(self.owned.begin), as_tuple(self.owned.end),
                         self.crossings.size());
           })
      .def_property_readonly(
          "region", [](const BlockCopy& self) { return as_tuple(self.owned); },
          "tuple of 2 index triples: first point of the block, and one more than the last point "
          "along each axis.")
      .def_property_readonly("slices", &slices_of,
                             "tuple of 3 slices: the part of an array over the whole grid that "
                             "belongs to the block.")
      .def_property_readonly(
          "inside",
          [](const py::object& self) {
            const auto& block = self.cast<const BlockCopy&>();
            return inside_view(block.inside, block.owned.size(), self);
          },
          "(nx, ny, nz) bool: whether each point of the block is inside the surface.")
      .def_property_readonly(
          "crossings",
          [](const std::shared_ptr<BlockCopy>& self) { return Crossings(self, self->crossings); },
          "Crossings: crossings of the edges whose lower ends belong to the block.");
  protect_instances(type);
}

}  // namespace

void bind_blocks(py::module_& module) {
  bind_block(module);
  py::class_<BlockStream, BlockStreamPointer> type(module, "BlockIterator", iterator_text);
  type.attr("__module__") = "eses_blocks";
  type.def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &next_block)
      .def("__repr__",
           [](const BlockStream& self) {
             return self.summary() != nullptr ? "<eses_blocks.BlockIterator: all blocks taken>"
                                              : "<eses_blocks.BlockIterator: not at its end>";
           })
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__",
           [](BlockStream& self, const py::args&) {
             const py::gil_scoped_release unlocked;
             self.close();
           })
      .def("close", &BlockStream::close, close_text, py::call_guard<py::gil_scoped_release>())
      .def_property_readonly(
          "area", [](const BlockStream& self) { return summary_of(self).area; },
          "float: area of the surface, in square angstrom.\n\nLike all totals it raises "
          "RuntimeError before the last block.")
      .def_property_readonly(
          "volume", [](const BlockStream& self) { return summary_of(self).volume; },
          "float: enclosed volume by the formula of ESES, in cubic angstrom, to compare with "
          "ESES.")
      .def_property_readonly(
          "divergence_volume",
          [](const BlockStream& self) { return summary_of(self).divergence_volume; },
          "float: enclosed volume by the divergence theorem, in cubic angstrom; more accurate "
          "than ``volume``.")
      .def_property_readonly(
          "atom_areas",
          [](const py::object& self) {
            const auto& areas = summary_of(self.cast<const BlockStream&>()).atom_areas;
            return field_view(areas.data(), areas.size(), sizeof(double), self);
          },
          "(N,) float64: share of each atom in the area, in square angstrom.");
  protect_instances(type);
}

}  // namespace eses::python
