/// Fuzzes the reader of atoms for the format that the build chooses. For any text the reader
/// returns atoms in their valid range or a well-formed error message. Line ends do not matter.
/// Atoms that are printed and read again are the same.

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "expect.hpp"
#include "parsed_atoms.hpp"

namespace eses::detail::fuzz {
namespace {

constexpr AtomFormat format = AtomFormat::ESES_FUZZ_FORMAT;
ParsedAtoms read(std::string_view text) {
  ParsedAtoms atoms = parse(text, format);
  const bool is_named = format == AtomFormat::pqr;
  expect(atoms.file.labels.size() == (is_named ? atoms.file.atoms.size() : 0),
         "atoms and their names");
  expect(atoms.file.charges.size() == atoms.file.labels.size(), "atoms and their charges");
  return atoms;
}

bool same(const ParsedAtoms& a, const ParsedAtoms& b) {
  const auto same_atom = [](const Atom& one, const Atom& other) {
    return one.center == other.center && one.radius == other.radius;
  };
  return a.message == b.message && std::equal(a.file.atoms.begin(), a.file.atoms.end(),
                                              b.file.atoms.begin(), b.file.atoms.end(), same_atom);
}

std::string with_crlf(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n') result += '\r';
    result += c;
  }
  return result;
}

std::string text_of(const std::vector<Atom>& atoms) {
  const bool is_pqr = format == AtomFormat::pqr;
  std::string text;
  for (const auto& [center, radius] : atoms) {
    text += fmt::format("{}{} {} {} {}{}\n", is_pqr ? "ATOM 1 N MET 1 " : "", center.x, center.y,
                        center.z, is_pqr ? "0.5 " : "", radius);
  }
  return text;
}

void check(std::string_view text) {
  const ParsedAtoms atoms = read(text);
  expect(same(atoms, read(with_crlf(text))), "CRLF is read in another way than LF");
  if (!atoms.message.empty()) return;
  expect_valid_atoms(atoms.file);
  expect(same(atoms, read(text_of(atoms.file.atoms))), "what is printed does not read back");
}

}  // namespace
}  // namespace eses::detail::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eses::detail::fuzz::check(eses::detail::fuzz::as_text(data, size));
  return 0;
}
