#include "cli/diagnostics.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "cli/command.hpp"
#include "cli/messages.hpp"
#include "eses/far_atoms.hpp"
#include "eses/grid.hpp"
#include "input/text_source.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

/// Returns the text between the lines of an atom and of the other atom.
std::string_view relation_of(DiagnosticKind kind) {
  switch (kind) {
    case DiagnosticKind::duplicate:
      return "as";
    case DiagnosticKind::close:
      return "near";
    default:
      return "in";
  }
}

/// Returns the number of a line, with the label of its atom if there is one.
std::string line_text(std::uint64_t line, const std::optional<std::string>& label) {
  return label ? formatted("{}, {}", line, *label) : formatted("{}", line);
}

std::string lines_text(const DiagnosticText& text, std::string_view relation) {
  std::vector<std::string> parts;
  bool has_labels = false;
  for (const DiagnosticText::Example& example : text.examples) {
    has_labels = has_labels || example.label;
    std::string& part = parts.emplace_back(line_text(example.line, example.label));
    if (example.other_line)
      part += formatted(" ({} {})", relation, line_text(*example.other_line, example.other_label));
  }
  const std::uint64_t more = text.count - text.examples.size();
  return formatted("{} {}{}", text.count == 1 ? "line" : "lines",
                   fmt::join(parts, has_labels ? "; " : ", "),
                   more > 0 ? formatted(" and {} more", more) : "");
}

/// Returns a label such as `A/LYS 33/CE`.
std::string label_text(const AtomLabel& label) {
  return formatted("{}/{} {}/{}", label.chain, label.residue, label.residue_number,
                   label.atom_name);
}

/// Returns the label of an atom, if it is known.
std::optional<std::string> label_text(const std::map<FileIndex, AtomLabel>& labels,
                                      FileIndex atom) {
  const auto found = labels.find(atom);
  return found == labels.end() ? std::nullopt : std::optional(label_text(found->second));
}

}  // namespace

static void to_json(Json& json, const DiagnosticText::Example& example) {
  json = {{"atom", example.atom},
          {"line", example.line},
          {"other_atom", example.other_atom},
          {"other_line", example.other_line}};
  if (example.label) json.update({{"label", *example.label}, {"other_label", example.other_label}});
}

void to_json(Json& json, const DiagnosticText& diagnostic) {
  json = {{"kind", diagnostic.name},
          {"severity", diagnostic.is_usual ? "note" : "warning"},
          {"count", diagnostic.count},
          {"message", diagnostic.message},
          {"first", diagnostic.examples}};
}

DiagnosticText program_warning(std::string_view name, std::string message) {
  return {.name = name, .short_text = {}, .message = std::move(message), .examples = {}};
}

DiagnosticText describe(const FarAtomsWarning& far, const std::map<FileIndex, AtomLabel>& labels) {
  DiagnosticText text = program_warning("far_atoms", far.message);
  text.count = far.count;
  for (const auto& [atom, line] : far.examples)
    text.examples.push_back({atom, line, label_text(labels, FileIndex{atom})});
  return text;
}

DiagnosticText describe(FarAtomsWarning far, const Surface& surface, const FileIndices& in_file) {
  std::map<FileIndex, AtomLabel> labels;
  for (auto& [atom, line] : far.examples) {
    const FileIndex index = in_file[atom];
    if (!surface.labels().empty()) labels[index] = surface.labels()[atom];
    atom = static_cast<AtomIndex>(as_number(index));
  }
  return describe(far, labels);
}

std::optional<DiagnosticText> far_atoms_of(const Surface& surface, const FileIndices& in_file,
                                           std::span<const std::uint64_t> lines,
                                           const std::filesystem::path& input) {
  const std::optional<FarAtoms> far = find_far_atoms(surface, GridOptions());
  if (!far || far->atoms.empty()) return std::nullopt;
  // More atoms are copies of a molecule, and no mistake. The first far atom needs no others.
  constexpr std::size_t atoms_per_far_atom = 10;
  if ((far->atoms.size() - 1) * atoms_per_far_atom > surface.atoms().size()) return std::nullopt;
  FarAtomsWarning warning{.message = {}, .count = far->atoms.size(), .examples = {}};
  for (const AtomIndex atom :
       std::span(far->atoms).first(std::min(far->atoms.size(), Diagnostic::max_examples)))
    warning.examples.emplace_back(atom, lines[as_number(in_file[atom])]);
  DiagnosticText text = describe(std::move(warning), surface, in_file);
  text.message = formatted("{}: {} far from all others: {}", input_name(input),
                           text.count == 1 ? "1 atom is" : formatted("{} atoms are", text.count),
                           lines_text(text, ""));
  return text;
}

std::vector<DiagnosticText> describe(const FileDiagnostics& diagnostics,
                                     const std::filesystem::path& input) {
  const auto& [all, lines, labels] = diagnostics;
  std::vector<DiagnosticText> texts;
  for (const Diagnostic& diagnostic : all) {
    DiagnosticText& text = texts.emplace_back();
    text.name = name_of(diagnostic.kind);
    text.is_usual = is_usual(diagnostic.kind);
    text.count = diagnostic.count;
    text.short_text = describe(diagnostic);
    for (const auto& [atom, other, of_record] : diagnostic.examples) {
      if (of_record > 0) {
        text.examples.push_back({.line = of_record});
        continue;
      }
      auto& example = text.examples.emplace_back(DiagnosticText::Example{
          atom, lines.at(FileIndex{atom}), label_text(labels, FileIndex{atom})});
      if (other == atom) continue;
      example.other_atom = other;
      example.other_line = lines.at(FileIndex{other});
      example.other_label = label_text(labels, FileIndex{other});
    }
    text.message = formatted("{}: {}: {}", input_name(input), text.short_text,
                             lines_text(text, relation_of(diagnostic.kind)));
  }
  return texts;
}

std::vector<DiagnosticText> describe(const AtomFile& atoms, const Surface& surface,
                                     const std::filesystem::path& input) {
  FileDiagnostics all;
  all.add(atoms.diagnostics, atoms.lines);
  all.add(surface.diagnostics(), atoms.lines);
  if (!surface.labels().empty())
    for (const auto& [atom, line] : all.lines) all.labels[atom] = surface.labels()[as_number(atom)];
  return describe(all, input);
}

std::vector<std::string> warnings_to_print(std::span<const DiagnosticText> diagnostics,
                                           bool is_strict, bool is_quiet) {
  std::vector<std::string> lines;
  for (const DiagnosticText& diagnostic : diagnostics)
    if (!diagnostic.is_usual && !diagnostic.is_printed) lines.push_back(diagnostic.message);
  if (is_strict && !lines.empty()) throw StrictError{std::move(lines)};
  if (is_quiet) lines.clear();
  return lines;
}

}  // namespace eses::detail::cli
