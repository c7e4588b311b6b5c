#include "atom_frames.hpp"

#include <algorithm>
#include <eses/eses.hpp>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "atoms.hpp"

namespace eses::python {
namespace {

constexpr const char* to_dataframe_text = R"(to_dataframe(self)
--

Make a table of the atoms. Needs pandas.

Returns
-------
pandas.DataFrame
    A row for each atom, by index from 0. The columns are ``serial`` (from 1), the texts ``name``,
    ``residue``, ``residue_number``, ``chain`` and ``element``, which are empty if they are unknown,
    the centre ``x``, ``y``, ``z`` and the ``radius`` in angstrom, and, for PQR files, the ``charge``
    in elementary charges.

Raises
------
ImportError
    If pandas is not installed.)";

constexpr const char* atom_table_text = R"(atom_table(self, atoms=None)
--

Make a table of the atoms with their areas. Needs pandas.

Parameters
----------
atoms : Atoms, optional
    The atoms of the surface, in the same order, for their names. Without it the names are empty.

Returns
-------
pandas.DataFrame
    A row for each atom, by index from 0. The columns are those of ``atoms.csv``: ``serial`` (from
    1), the texts ``name``, ``residue``, ``residue_number``, ``chain`` and ``element``, which are empty
    if they are unknown, the ``radius`` in angstrom and the ``area`` in square angstrom.

Raises
------
ImportError
    If pandas is not installed.
ValueError
    If the number of atoms or their order is not that of the surface.)";

py::object frame_type(const char* caller) {
  try {
    return py::module_::import("pandas").attr("DataFrame");
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_ModuleNotFoundError)) throw;
    const std::string text =
        std::string(caller) + " needs pandas; install it, for example with `pip install pandas`";
    py::raise_from(error, PyExc_ImportError, text.c_str());
    throw py::error_already_set();
  }
}

/// Returns the columns of the names of `count` atoms. The names are empty if the file has none.
py::dict name_columns(std::size_t count, const AtomFile& file) {
  py::dict columns;
  columns["serial"] = py::module_::import("numpy").attr("arange")(1, count + 1);
  columns["name"] = texts_of(file, count, &AtomLabel::atom_name);
  columns["residue"] = texts_of(file, count, &AtomLabel::residue);
  columns["residue_number"] = texts_of(file, count, &AtomLabel::residue_number);
  columns["chain"] = texts_of(file, count, &AtomLabel::chain);
  columns["element"] = texts_of(file, count, &AtomLabel::element);
  return columns;
}

py::object frame_of(const std::shared_ptr<AtomFile>& file) {
  const py::object frame = frame_type("to_dataframe"), self = py::cast(file);
  py::dict columns = name_columns(file->atoms.size(), *file);
  const py::array centers = centers_view(file->atoms, self);
  for (const auto& [name, axis] : {std::pair("x", 0), std::pair("y", 1), std::pair("z", 2)})
    columns[name] = centers[py::make_tuple(py::ellipsis(), axis)];
  columns["radius"] = radii_view(file->atoms, self);
  if (!file->charges.empty()) columns["charge"] = self.attr("charge");
  return frame(columns);
}

bool is_less(const Atom& a, const Atom& b) {
  return std::tie(a.center.x, a.center.y, a.center.z) <
         std::tie(b.center.x, b.center.y, b.center.z);
}

bool has_same_center(const Atom& a, const Atom& b) { return a.center == b.center; }

/// Raises ValueError if the atoms differ from the others in their number, or have the same centres
/// in another order. Atoms with other centres, such as those of another frame, are accepted.
void require_order(std::span<const Atom> atoms, std::span<const Atom> others) {
  if (atoms.size() != others.size())
    throw py::value_error("the surface has " + std::to_string(others.size()) + " atoms, but " +
                          std::to_string(atoms.size()) + " are given");
  if (std::ranges::equal(atoms, others, has_same_center)) return;
  std::vector<Atom> a(atoms.begin(), atoms.end()), b(others.begin(), others.end());
  std::ranges::sort(a, is_less);
  std::ranges::sort(b, is_less);
  if (std::ranges::equal(a, b, has_same_center))
    throw py::value_error("the atoms are those of the surface in another order");
}

py::object table_of(const std::shared_ptr<ComputedResult>& result, const AtomFile* atoms) {
  const std::span<const Atom> own = result->surface.atoms();
  if (atoms != nullptr) require_order(atoms->atoms, own);
  const py::object frame = frame_type("atom_table"), self = py::cast(result);
  const AtomFile unnamed;
  py::dict columns = name_columns(own.size(), atoms != nullptr ? *atoms : unnamed);
  columns["radius"] = radii_view(own, self);
  columns["area"] = self.attr("atom_areas");
  return frame(columns);
}

}  // namespace

void bind_atoms_frame(py::class_<AtomFile, std::shared_ptr<AtomFile>>& atoms) {
  atoms.def("to_dataframe", &frame_of, to_dataframe_text);
}

void bind_atom_table(py::module_& module,
                     py::class_<ComputedResult, std::shared_ptr<ComputedResult>>& result) {
  result.def("atom_table", &table_of, atom_table_text, py::arg("atoms") = py::none());
  module.def("_require_order", [](const ComputedResult& of, const AtomFile& atoms) {
    require_order(atoms.atoms, of.surface.atoms());
  });
}

}  // namespace eses::python
