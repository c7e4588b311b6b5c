#include "cli/diagnostics.hpp"

#include <fmt/format.h>

namespace eses::detail::cli {
namespace {

struct Wording {
  std::string_view name;
  std::string_view one, several;  // behind the count
  std::string_view relation;      // between the line of an atom and that of the other
};

Wording wording_of(DiagnosticKind kind) {
  switch (kind) {
    case DiagnosticKind::duplicate:
      return {"duplicate", "atom has the centre and radius of an earlier one",
              "atoms have the centre and radius of an earlier one", "as"};
    case DiagnosticKind::close:
      return {"close", "atom is within 0.5 angstrom of an earlier one",
              "atoms are within 0.5 angstrom of an earlier one", "near"};
    case DiagnosticKind::nested:
      return {"nested", "atom lies wholly inside another one",
              "atoms lie wholly inside another one", "in"};
    case DiagnosticKind::large_radius:
      return {"large_radius", "atom has a radius above 4 angstrom",
              "atoms have a radius above 4 angstrom", ""};
    case DiagnosticKind::small_radii:
      return {"small_radii",
              "atom, and none with a radius of 0.4 angstrom or more; are lengths in "
              "nanometres?",
              "atoms, and none with a radius of 0.4 angstrom or more; are lengths in nanometres?",
              ""};
    case DiagnosticKind::zero_radius:
      return {"zero_radius", "of radius 0", "of radius 0", ""};
    case DiagnosticKind::nested_usual:
      return {"nested_hydrogen", "of at most 1.4 angstrom inside another atom",
              "of at most 1.4 angstrom inside another atom", "in"};
  }
  return {};
}

std::string lines_text(const DiagnosticText& text, std::string_view relation) {
  std::vector<std::string> parts;
  for (const DiagnosticText::Example& example : text.examples)
    parts.push_back(example.has_other
                        ? fmt::format("{} ({} {})", example.line, relation, example.other_line)
                        : fmt::format("{}", example.line));
  const std::uint64_t more = text.count - text.examples.size();
  return fmt::format("{} {}{}", text.count == 1 ? "line" : "lines", fmt::join(parts, ", "),
                     more > 0 ? fmt::format(" and {} more", more) : "");
}

DiagnosticText describe(const Diagnostic& diagnostic, const LineOf& line_of,
                        const std::filesystem::path& input) {
  const Wording wording = wording_of(diagnostic.kind);
  DiagnosticText text;
  text.name = wording.name;
  text.is_usual = is_usual(diagnostic.kind);
  text.count = diagnostic.count;
  text.short_text = diagnostic.count == 1 ? wording.one : wording.several;
  for (const auto& [atom, other] : diagnostic.examples)
    text.examples.push_back({atom, line_of(atom), atom != other, other, line_of(other)});
  text.message = fmt::format("{}: {} {}: {}", input == "-" ? "<stdin>" : input.string(), text.count,
                             text.short_text, lines_text(text, wording.relation));
  return text;
}

}  // namespace

std::vector<DiagnosticText> describe(std::span<const Diagnostic> diagnostics, const LineOf& line_of,
                                     const std::filesystem::path& input) {
  std::vector<DiagnosticText> texts;
  for (const Diagnostic& diagnostic : diagnostics)
    texts.push_back(describe(diagnostic, line_of, input));
  return texts;
}

}  // namespace eses::detail::cli
