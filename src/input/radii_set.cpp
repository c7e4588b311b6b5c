#include "input/radii_set.hpp"

#include <fmt/ranges.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <system_error>
#include <unordered_map>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "input/advice.hpp"
#include "input/radii_tables.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

constexpr double msms_hydrogen_radius = 1.20;  // angstrom

// ------------------------------------------------------------------ FreeSASA configuration files

enum class Section { none, types, atoms };

/// Radii by residue name and atom name, separated by a blank. The residue name ANY stands for all
/// residues.
using NamedRadii = std::unordered_map<std::string, double>;

/// Returns the radius `find(residue, atom)` of the names of an atom, else of the standard names in
/// the place of those of force fields, such as HIS for HIE.
template <class Find>
std::optional<double> find_by_names(const AtomIdentity& atom, Find&& find) {
  if (const std::optional<double> radius = find(atom.residue, atom.atom)) return radius;
  if (atom.standard != atom.residue)
    if (const std::optional<double> radius = find(atom.standard, atom.atom)) return radius;
  const std::string name = standard_atom(atom.standard, atom.atom);
  return name == atom.atom ? std::nullopt : find(atom.standard, name);
}

/// Returns what find_by_names returns, else the radius of the residue ANY.
template <class Find>
std::optional<double> find_with_any(const AtomIdentity& atom, Find&& find) {
  if (const std::optional<double> radius = find_by_names(atom, find)) return radius;
  return find_by_names(atom,
                       [&](std::string_view, std::string_view name) { return find("ANY", name); });
}

std::optional<double> find_named(const NamedRadii& radii, const AtomIdentity& atom) {
  return find_with_any(atom, [&](std::string_view residue, std::string_view name) {
    const auto found = radii.find(formatted("{} {}", residue, name));
    return found == radii.end() ? std::nullopt : std::optional(found->second);
  });
}

using FindRadius = std::optional<double> (*)(std::string_view residue, std::string_view atom);

/// Returns a set of united atoms whose names in the residue ANY begin with their element, so that
/// CA is not calcium.
RadiiSet set_with_any(std::string name, FindRadius find) {
  return {.name = std::move(name),
          .is_united = true,
          .find_named =
              [find](const AtomIdentity& atom) {
                const bool is_of_any = !atom.atom.empty() && atom.element == atom.atom.substr(0, 1);
                return is_of_any ? find_with_any(atom, find) : find_by_names(atom, find);
              },
          .find_by_element = freesasa_element_radius};
}

/// Returns the set of NACCESS, in which sulfur, selenium and phosphorus are apolar.
RadiiSet naccess_set(std::string name) {
  RadiiSet set = set_with_any(std::move(name), naccess_radius);
  set.find_class = [](const AtomIdentity& atom) {
    return has_word("S Se P", atom.element) ? AtomClass::apolar : AtomClass::none;
  };
  return set;
}

/// Returns the set of OONS, in which the carbon of carbonyl and carboxyl groups is polar. It is the
/// carbon of this radius.
RadiiSet oons_set(std::string name) {
  RadiiSet set = set_with_any(std::move(name), oons_radius);
  set.find_class = [find = set.find_named](const AtomIdentity& atom) {
    constexpr double carbonyl_radius = 1.55;  // angstrom
    return atom.element == "C" && find(atom) == carbonyl_radius ? AtomClass::polar
                                                                : AtomClass::none;
  };
  return set;
}

constexpr std::string_view with_ions = "+shannon";  // the end of the name of a set

/// Returns the name of a set or file without the end that asks for radii of ions.
std::string without_ions(std::string_view name) {
  const bool has_end = lower_case(std::string(name)).ends_with(with_ions);
  return std::string(name.substr(0, name.size() - (has_end ? with_ions.size() : 0)));
}

bool is_there(const std::string& file) {
  std::error_code ignored;  // such as a name that is too long
  return std::filesystem::exists(file, ignored);
}

/// Returns a set with other radii for ions that are residues by themselves.
RadiiSet with_ionic_radii(RadiiSet set) {
  set.name += with_ions;
  set.find_named = [others = set.find_named](const AtomIdentity& atom) {
    const std::optional<double> radius = ionic_radius(atom.residue, atom.atom, atom.element);
    return radius ? radius : others(atom);
  };
  return set;
}

/// Reads a configuration file line by line.
class ConfigurationReader {
 public:
  explicit ConfigurationReader(std::string_view file) : file_(file) {}

  void read_line(std::string_view line) {
    ++line_;
    line = line.substr(0, line.find('#'));
    std::string_view rest = line;
    const std::string_view first = take_first(rest);
    if (first.empty()) return;
    if (first == "types:" || first == "atoms:")
      section_ = first == "types:" ? Section::types : Section::atoms;
    else if (first == "name:")
      read_name(rest);
    else
      read_entry(line);
  }

  RadiiSet finished() && {
    if (radii_.empty())
      throw Error(
          formatted("{}: no atoms found; expected a set of radii in FreeSASA's "
                    "configuration format, with the sections types: and atoms:",
                    file_));
    return {.name = name_,
            .is_united = !names_hydrogens_,
            .find_named = [radii = std::move(radii_)](
                              const AtomIdentity& atom) { return find_named(radii, atom); },
            .find_by_element = freesasa_element_radius,
            .is_from_file = true,
            .find_class =
                [are_polar = std::move(are_polar_)](const AtomIdentity& atom) {
                  const std::optional<double> is_polar = find_named(are_polar, atom);
                  return !is_polar       ? AtomClass::none
                         : *is_polar > 0 ? AtomClass::polar
                                         : AtomClass::apolar;
                }};
  }

 private:
  [[noreturn]] void fail(std::string_view what) const { fail_at_line(file_, line_, what); }

  void read_name(std::string_view rest) {
    name_ = take_first(rest);
    if (name_.empty()) fail("expected a name after name:");
    section_ = Section::none;
  }

  void read_entry(std::string_view line) {
    std::string_view rest = line;
    const std::string_view first = take_first(rest), second = take_first(rest),
                           third = take_first(rest);
    if (section_ == Section::none)
      fail(formatted("expected types:, atoms: or name:, found {}", quoted(first)));
    if (third.empty())
      fail(section_ == Section::types ? "expected three fields, TYPE RADIUS polar|apolar"
                                      : "expected three fields, RESIDUE ATOM TYPE");
    if (section_ == Section::types)
      add_type(first, second, third);
    else
      add_atom(first, second, third);
  }

  void add_type(std::string_view type, std::string_view number, std::string_view polarity) {
    double radius = 0;
    if (parse_number(number, radius) != std::errc{} || !(radius >= 0 && radius <= max_set_radius))
      fail(formatted("expected a radius from 0 to {:.0f} angstrom, found {}", max_set_radius,
                     quoted(number)));
    if (types_.emplace(std::string(type), radius).first->second != radius)
      fail(formatted("the type {} has another radius already", quoted(type)));
    // Some files divide types in another way, such as backbone and sidechain.
    const std::string word = lower_case(std::string(polarity));
    if (word == "polar" || word == "apolar")
      polar_types_.emplace(std::string(type), word == "polar" ? 1.0 : 0.0);
  }

  void add_atom(std::string_view residue, std::string_view atom, std::string_view type) {
    const auto found = types_.find(std::string(type));
    if (found == types_.end())
      fail(formatted("the type {} has no radius; types: must come before atoms:", quoted(type)));
    const auto [entry, is_new] = radii_.emplace(formatted("{} {}", residue, atom), found->second);
    if (const double before = entry->second; before != found->second)
      fail(formatted("the atom {} of {} has another radius already, {}; remove one of the entries",
                     quoted(atom), quoted(residue), before));
    if (const auto polarity = polar_types_.find(std::string(type)); polarity != polar_types_.end())
      are_polar_.emplace(formatted("{} {}", residue, atom), polarity->second);
    if (is_hydrogen_name(atom)) names_hydrogens_ = true;
  }

  static bool is_hydrogen_name(std::string_view atom) {
    while (!atom.empty() && is_digit(atom.front())) atom.remove_prefix(1);
    return atom.starts_with('H') || atom.starts_with('D');
  }

  std::string_view file_;
  std::uint64_t line_ = 0;
  Section section_ = Section::none;
  std::string name_ = "unnamed";
  std::unordered_map<std::string, double> types_;
  std::unordered_map<std::string, double> polar_types_;  ///< values as in are_polar_
  NamedRadii radii_;
  NamedRadii are_polar_;  ///< 1 for polar atoms, 0 for apolar ones
  bool names_hydrogens_ = false;
};

/// The identity of an atom with its names in upper case.
struct UpperCase {
  explicit UpperCase(const AtomIdentity& atom)
      : residue(upper_case(std::string(atom.residue))),
        name(upper_case(std::string(atom.atom))),
        identity{residue, name, atom.element, atom.is_hydrogen},
        differs(residue != atom.residue || name != atom.atom) {
    if (residue == atom.residue) identity.standard = atom.standard;
  }
  UpperCase(const UpperCase&) = delete;
  UpperCase& operator=(const UpperCase&) = delete;

  std::string residue, name;
  AtomIdentity identity;
  bool differs;
};

}  // namespace

std::optional<FoundRadius> RadiiSet::find(const AtomIdentity& atom) const {
  if (const auto radius = find_named(atom)) return FoundRadius{*radius, false};
  if (const UpperCase upper(atom); upper.differs)
    if (const auto radius = find_named(upper.identity)) return FoundRadius{*radius, false};
  if (const auto radius = find_by_element(atom.element)) return FoundRadius{*radius, true};
  return std::nullopt;
}

AtomClass RadiiSet::class_of(const AtomIdentity& atom) const {
  if (!find_class) return AtomClass::none;
  const AtomClass found = find_class(atom);
  if (found != AtomClass::none) return found;
  const UpperCase upper(atom);
  return upper.differs ? find_class(upper.identity) : found;
}

std::optional<RadiiSet> named_radii_set(std::string_view name) {
  const std::string word = lower_case(std::string(name));  // publications write ProtOr
  if (word.ends_with(with_ions)) {
    std::optional<RadiiSet> base = named_radii_set(without_ions(word));
    if (!base || base->is_occupancy || base->name.ends_with(with_ions)) return std::nullopt;
    return with_ionic_radii(*std::move(base));
  }
  if (word == "protor")
    return RadiiSet{word, true,
                    [](const AtomIdentity& atom) { return find_by_names(atom, protor_radius); },
                    freesasa_element_radius};
  if (word == "bondi")
    return RadiiSet{word, false,
                    [](const AtomIdentity& atom) { return bondi_radius(atom.element); },
                    bondi_radius};
  if (word == "msms")
    return RadiiSet{word, true,
                    [](const AtomIdentity& atom) {
                      return atom.is_hydrogen ? std::optional(msms_hydrogen_radius)
                                              : msms_radius(atom.residue, atom.atom);
                    },
                    bondi_radius};
  if (word == "naccess") return naccess_set(word);
  if (word == "oons") return oons_set(word);
  if (word == "occupancy")
    return RadiiSet{.name = word,
                    .find_named = [](const AtomIdentity&) { return std::optional(0.0); },
                    .find_by_element = bondi_radius,
                    .is_from_file = true,
                    .is_occupancy = true};
  return std::nullopt;
}

std::string radii_file(const std::string& name) {
  const std::string base = without_ions(name);
  return !is_there(name) && is_there(base) ? base : name;
}

RadiiSet find_radii_set(const std::string& name_or_file) {
  if (std::optional<RadiiSet> named = named_radii_set(name_or_file)) return *std::move(named);
  constexpr std::uint64_t max_bytes = std::uint64_t{4} << 20;  // valid files have a few kilobytes
  const std::string file = radii_file(name_or_file);
  try {
    TextSource source{std::filesystem::path(file)};
    RadiiSet set = parse_radii_set(read_text(source, ReadingLimit(0), {}, max_bytes), file);
    return file == name_or_file ? set : with_ionic_radii(std::move(set));
  } catch (const Error& error) {
    if (is_there(file)) throw;
    const std::vector<std::string> names{"protor", "bondi", "msms", "naccess", "oons", "occupancy"};
    const auto all_but_last = std::span(names).first(names.size() - 1);
    std::vector<std::string> known = names;
    for (const std::string& each : all_but_last) known.push_back(each + std::string(with_ions));
    const std::string word = lower_case(name_or_file);
    if (word.starts_with("protor+") && word.find("+ccd") != word.npos)
      throw Error(
          "radii: +ccd needs the Chemical Component Dictionary of Biotite; use eses.measure or "
          "eses.read_molecule of Python");
    const std::string_view meant =
        word == with_ions.substr(1) ? known.at(names.size()) : closest_name(word, known);
    throw Error(
        formatted("radii: expected {}, one of them with {}, {}, or a file in FreeSASA's "
                  "configuration format: {}{}",
                  fmt::join(all_but_last, ", "), with_ions, names.back(), error.what(),
                  meant.empty() ? "" : formatted("; did you mean {}?", meant)));
  }
}

RadiiSet parse_radii_set(std::string_view text, std::string_view file) {
  ConfigurationReader reader(file);
  while (!text.empty()) reader.read_line(take_line(text));
  return std::move(reader).finished();
}

}  // namespace eses::detail
