#include "warn.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace py = pybind11;

namespace eses::python {
namespace {

// Returns the level of the first function on the stack that is not of this package, from 1.
int level_of_caller() {
  const auto path = py::module_::import("os.path");
  const auto folder_of = [&](const py::object& file) { return path.attr("dirname")(file); };
  const py::object package = folder_of(py::module_::import("eses_blocks").attr("__file__"));
  int level = 1;
  py::object frame = py::module_::import("sys").attr("_getframe")(0);
  for (; !frame.is_none(); frame = frame.attr("f_back"), ++level)
    if (!folder_of(frame.attr("f_code").attr("co_filename")).equal(package)) return level;
  return 1;
}

using NumberOf = std::function<std::uint64_t(const Diagnostic::Example&)>;

// Returns the numbers of the examples, such as `lines 3, 7 and 12 more`.
std::string list_text(const Diagnostic& diagnostic, const std::string& one,
                      const std::string& several, const NumberOf& number_of) {
  std::string text = diagnostic.count == 1 ? one : several;
  for (std::size_t i = 0; i < diagnostic.examples.size(); ++i)
    text += (i == 0 ? " " : ", ") + std::to_string(number_of(diagnostic.examples[i]));
  if (const std::uint64_t more = diagnostic.count - diagnostic.examples.size(); more > 0)
    text += " and " + std::to_string(more) + " more";
  return text;
}

std::string text_of(const Diagnostic& diagnostic) {
  return describe(diagnostic) + ": " +
         list_text(diagnostic, "index", "indices",
                   [](const Diagnostic::Example& example) { return example.atom; });
}

}  // namespace

void warn(const py::str& text) {
  const auto warnings = py::module_::import("warnings");
  warnings.attr("warn")(text, py::reinterpret_borrow<py::object>(PyExc_UserWarning),
                        py::arg("stacklevel") = level_of_caller());
}

void warn_about(std::span<const Diagnostic> diagnostics, const std::string& start) {
  for (const Diagnostic& diagnostic : diagnostics)
    if (!is_usual(diagnostic.kind)) warn(start + text_of(diagnostic));
}

void warn_about(const AtomFile& file, const py::str& name) {
  const auto line_of = [&](const Diagnostic::Example& example) {
    return example.line > 0 ? example.line : file.lines[example.atom];
  };
  for (const Diagnostic& diagnostic : file.diagnostics)
    if (!is_usual(diagnostic.kind))
      warn(
          py::str("{}: {}: {}")
              .format(name, describe(diagnostic), list_text(diagnostic, "line", "lines", line_of)));
}

void warn_about_stray_atoms(const Surface& surface, std::span<const std::int64_t> kept) {
  std::vector<AtomIndex> strays;
  {
    const py::gil_scoped_release unlocked;
    strays = find_stray_atoms(surface);
  }
  if (strays.empty()) return;
  Diagnostic diagnostic;
  diagnostic.count = strays.size();
  for (std::size_t i = 0; i < std::min(strays.size(), Diagnostic::max_examples); ++i)
    diagnostic.examples.push_back({strays[i], strays[i]});
  const std::string atoms =
      strays.size() == 1 ? "1 atom is" : std::to_string(strays.size()) + " atoms are";
  warn(atoms + " far from all others: " +
       list_text(diagnostic, "index", "indices", [&](const Diagnostic::Example& example) {
         return static_cast<std::uint64_t>(kept[example.atom]);
       }));
}

void check_far_atoms(const Surface& surface, const GridOptions& grid, bool are_allowed) {
  std::optional<FarAtoms> far;
  {
    const py::gil_scoped_release unlocked;
    far = find_far_atoms(surface, grid);
  }
  if (!far) return;
  if (far->is_refused() && !are_allowed)
    throw py::value_error(describe(*far) +
                          "; leave out atoms that do not belong to the molecule, or give "
                          "allow_far_atoms=True");
  warn(describe(*far));
}

}  // namespace eses::python
