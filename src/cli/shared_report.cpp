#include "cli/shared_report.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/messages.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "output/area_tables.hpp"
#include "system/formatted.hpp"

namespace eses {

static void to_json(detail::Json& json, const RadiusSource& source) {
  json = {{"residue", source.residue},
          {"atom_name", source.atom_name},
          {"element", source.element},
          {"radius", source.radius},
          {"count", source.count}};
}

static void to_json(detail::Json& json, const OtherAssembly& other) {
  json = {{"id", other.id}, {"operators", other.operators}, {"atoms", other.atoms}};
}

static void to_json(detail::Json& json, const ChainName& name) {
  json = {{"auth", name.auth}, {"label", name.label}};
}

}  // namespace eses

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

/// A count of the report, with its names in text and JSON.
struct Count {
  std::string_view one, several;
  std::string_view key;
  std::uint64_t StructureReport::*member;
};

constexpr std::array kept_counts{
    Count{"ATOM record", "ATOM records", "atom_records", &StructureReport::atom_records},
    Count{"HETATM record", "HETATM records", "hetatm_records", &StructureReport::hetatm_records},
    Count{"atom of water", "atoms of water", "waters", &StructureReport::waters},
};

constexpr std::array dropped_counts{
    Count{"atom of other chains", "atoms of other chains", "chains",
          &StructureReport::dropped_chains},
    Count{"atom not selected", "atoms not selected", "selection",
          &StructureReport::dropped_selection},
    Count{"atom of water", "atoms of water", "waters", &StructureReport::dropped_waters},
    Count{"HETATM record", "HETATM records", "hetatm_records", &StructureReport::dropped_hetatm},
    Count{"hydrogen", "hydrogens", "hydrogens", &StructureReport::dropped_hydrogens},
    Count{"atom of another alternate location", "atoms of other alternate locations", "altlocs",
          &StructureReport::dropped_altlocs},
    Count{"dummy atom of occupancy 0 at 9999", "dummy atoms of occupancy 0 at 9999", "dummies",
          &StructureReport::dropped_dummies},
    Count{"atom not in the assembly", "atoms not in the assembly", "assembly",
          &StructureReport::dropped_assembly},
    Count{"image that coincides with an earlier one", "images that coincide with an earlier one",
          "images", &StructureReport::dropped_images},
};

std::string atom_counts_text(const StructureReport& report, const auto& counts) {
  std::vector<std::string> parts;
  for (const Count& count : counts)
    if (const std::uint64_t value = report.*count.member; value > 0)
      parts.push_back(formatted("{} {}", value, value == 1 ? count.one : count.several));
  return formatted("{}", fmt::join(parts, ", "));
}

Json counts_json(const StructureReport& report, const auto& counts) {
  Json object = Json::object();
  for (const Count& count : counts) object.update({{std::string(count.key), report.*count.member}});
  return object;
}

std::uint64_t count_atoms(const std::vector<RadiusSource>& sources) {
  std::uint64_t atoms = 0;
  for (const RadiusSource& source : sources) atoms += source.count;
  return atoms;
}

/// Returns the sources of radii, such as `12 atoms by element (HEM FE 1.26, ...)`.
std::string sources_text(const std::vector<RadiusSource>& sources, std::string_view how) {
  if (sources.empty()) return "";
  const auto text = [](const RadiusSource& source) {
    return printable(formatted("{} {} {}", source.residue, source.atom_name, source.radius));
  };
  return formatted("; {} {} ({})", counted(count_atoms(sources), "atom"), how,
                   first_texts(sources, 4, text));
}

/// Returns the line of the atoms whose elements were derived from names.
std::string guessed_text(const std::vector<RadiusSource>& sources) {
  if (sources.empty()) return "";
  const auto text = [](const RadiusSource& source) {
    return printable(formatted("{} {}: {}", source.residue, source.atom_name, source.element));
  };
  constexpr std::size_t max_texts = 8;
  return formatted("elements: {} by name, not by the file ({}){}\n",
                   counted(count_atoms(sources), "atom"), first_texts(sources, max_texts, text),
                   sources.size() > max_texts ? "; --json lists all" : "");
}

/// Returns the note on chains that are segments.
std::string segments_text(const std::vector<std::string>& chains) {
  if (chains.empty()) return "";
  return formatted("note: chains are named by the segments in columns 73 to 76: {}\n",
                   first_texts(chains, 8, printable));
}

std::string model_text(const StructureReport& report) {
  return report.models < 2
             ? ""
             : formatted(" of model {} ({} models)", printable(report.model), report.models);
}

std::string assembly_text(const StructureReport& report) {
  if (report.assembly.empty()) return "";
  return formatted("; assembly {} by {}", printable(report.assembly),
                   counted(report.operators, "operator"));
}

/// Returns a note such as `assembly 1 has 20 copies; build it with --assembly 1`.
std::string other_assemblies_text(const StructureReport& report) {
  const std::vector<OtherAssembly>& others = report.other_assemblies;
  if (others.empty()) return "";
  const std::uint64_t atoms = report.atom_records + report.hetatm_records + report.waters;
  const auto text = [&](const OtherAssembly& other) {
    const std::string copies = other.operators > 1 ? formatted("{} copies", other.operators) : "";
    const std::string part =
        other.atoms < atoms ? formatted("{} of the {} atoms", other.atoms, atoms) : "";
    return formatted("assembly {} has {}{}{}", printable(other.id), copies,
                     copies.empty() || part.empty() ? "" : " of ", part);
  };
  return formatted("note: {}; build {}\n", first_texts(others, 4, text),
                   others.size() == 1
                       ? formatted("it with --assembly {}", printable(others.front().id))
                       : "one with --assembly ID");
}

bool is_vector(const Json& value) {
  return value.is_array() && value.size() == 3 && value[0].is_number_float();
}

std::string field_text(const Json& value) {
  if (value.is_number_float()) return formatted("{:.6f}", value.get<double>());
  if (value.is_string()) return csv_field(value.get_ref<const std::string&>());
  if (!value.is_array()) return value.dump();
  if (is_vector(value))
    return formatted("{},{},{}", field_text(value[0]), field_text(value[1]), field_text(value[2]));
  if (!value.empty() && value[0].is_string())
    return csv_field(formatted("{}", fmt::join(value.get<std::vector<std::string>>(), "; ")));
  return formatted("{}", fmt::join(value.get<std::vector<std::uint64_t>>(), " "));
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
  const std::vector<AtomIndex> strays = find_stray_atoms(surface);
  if (strays.empty()) return std::nullopt;
  FarAtomsWarning warning{.message = {}, .count = strays.size(), .examples = {}};
  for (const AtomIndex atom :
       std::span(strays).first(std::min(strays.size(), Diagnostic::max_examples)))
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

std::string structure_text(const StructureReport& report) {
  const std::string dropped = atom_counts_text(report, dropped_counts);
  return formatted(
      "read: {}{}{}\n{}radii: {}{}{}\n{}{}{}{}", atom_counts_text(report, kept_counts),
      model_text(report), assembly_text(report),
      dropped.empty() ? "" : formatted("left out: {}\n", dropped), printable(report.radii),
      sources_text(report.by_element, "by element"),
      sources_text(report.unknown, "of unknown radius"), guessed_text(report.guessed_elements),
      segments_text(report.segment_chains),
      report.chain_names == ChainNames::label ? "note: chains are named by label_asym_id\n" : "",
      other_assemblies_text(report));
}

std::span<const ChainName> ReportedInput::label_chains() const {
  if (!structure || structure->chain_names != ChainNames::label) return {};
  return structure->chains;
}

std::string heading_text(const ReportedInput& input, std::size_t atoms, double probe_radius) {
  const std::string count = counted(atoms, "atom");
  std::string text = formatted("{}: {}, probe radius {} angstrom\n",
                               one_line(input_name(input.path)), count, probe_radius);
  if (input.structure) text += structure_text(*input.structure);
  const auto waters =  // of a PQR file
      std::ranges::find(input.diagnostics, name_of(DiagnosticKind::water), &DiagnosticText::name);
  if (waters != input.diagnostics.end())
    text += formatted("read: {}; {}\n", count, waters->short_text);
  return text;
}

Json first_members(const ReportedInput& input, std::size_t atoms, double probe_radius) {
  Json object{{"file", input.path.string()}, {"atoms", atoms}, {"probe_radius", probe_radius}};
  if (input.model) object["model"] = *input.model;
  return object;
}

void add_last_members(Json& object, const ReportedInput& input) {
  if (input.structure) object["structure"] = *input.structure;
  object["diagnostics"] = input.diagnostics;
}

std::string shown_name(std::string_view name) { return name.empty() ? "no chain" : one_line(name); }

std::uint64_t left_out_atoms(const StructureReport& report) {
  std::uint64_t atoms = 0;
  for (const Count& count : dropped_counts) atoms += report.*count.member;
  return atoms;
}

std::string csv_heading(const Json& record) {
  std::vector<std::string> names;
  for (const auto& [name, value] : record.items())
    names.push_back(is_vector(value) ? formatted("{0}_x,{0}_y,{0}_z", name) : name);
  return formatted("{}", fmt::join(names, ","));
}

std::string csv_row(const Json& record) {
  std::vector<std::string> fields;
  for (const Json& value : record) fields.push_back(field_text(value));
  return formatted("{}", fmt::join(fields, ","));
}

std::string filling_text(std::span<const FilledCavity> filled) {
  if (filled.empty()) return "filled cavities: none\n";
  return formatted("filled cavities: {}, with voids from {:.6g} to {:.6g} cubic angstrom\n",
                   filled.size(), filled.back().void_volume, filled.front().void_volume);
}

}  // namespace eses::detail::cli

void eses::to_json(detail::Json& json, const StructureReport& report) {
  using namespace detail::cli;
  json = {{"model", report.model},
          {"models", report.models},
          {"assembly", report.assembly.empty() ? detail::Json() : detail::Json(report.assembly)},
          {"operators", report.operators},
          {"other_assemblies", report.other_assemblies},
          {"read", counts_json(report, kept_counts)},
          {"left_out", counts_json(report, dropped_counts)},
          {"radii", report.radii},
          {"radii_by_element", report.by_element},
          {"unknown_radii", report.unknown},
          {"elements_by_name", report.guessed_elements},
          {"segment_chains", report.segment_chains},
          {"chain_names", report.chain_names == ChainNames::label ? "label" : "auth"},
          {"chains", report.chains}};
}
