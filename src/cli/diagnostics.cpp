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

/// Returns the warning about the atoms of find_stray_atoms; nothing if there are none.
std::optional<DiagnosticText> far_atoms_text(const AtomFile& atoms, const Surface& surface,
                                             const std::filesystem::path& input) {
  const std::vector<AtomIndex> strays = find_stray_atoms(surface);
  if (strays.empty()) return std::nullopt;
  DiagnosticText text = program_warning(far_atoms_name, "");
  text.count = strays.size();
  for (const AtomIndex atom :
       std::span(strays).first(std::min(strays.size(), Diagnostic::max_examples)))
    text.examples.push_back({.atom = atom,
                             .line = atoms.lines[atom],
                             .label = surface.labels().empty()
                                          ? std::nullopt
                                          : std::optional(label_text(surface.labels()[atom]))});
  text.message = formatted("{}: {} far from all others: {}", input_name(input),
                           text.count == 1 ? "1 atom is" : formatted("{} atoms are", text.count),
                           lines_text(text, ""));
  return text;
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
  DiagnosticText text = program_warning(far_atoms_name, far.message);
  text.count = far.count;
  for (const auto& [atom, line] : far.examples)
    text.examples.push_back({atom, line, label_text(labels, FileIndex{atom})});
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
  std::vector<DiagnosticText> texts = describe(all, input);
  if (std::optional<DiagnosticText> far = far_atoms_text(atoms, surface, input))
    texts.push_back(*std::move(far));
  return texts;
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
