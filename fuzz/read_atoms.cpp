/// Fuzzes the reader of atoms for the format that the build chooses. For any text the reader
/// returns atoms in their valid range or a well-formed error message. Line ends do not matter.
/// Atoms that are printed and read again are the same.

#include "eses/read_atoms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "expect.hpp"

namespace eses::detail::fuzz {
namespace {

constexpr AtomFormat format = AtomFormat::ESES_FUZZ_FORMAT;
constexpr std::string_view name = "input";
constexpr double max_length = 1e6;  // angstrom

/// The atoms, or the error message if there are none.
struct Outcome {
  std::vector<Atom> atoms;
  std::string message;
};

Outcome read(std::string_view text) {
  try {
    AtomFile atoms = parse_atoms(text, format, name);
    const bool is_named = format == AtomFormat::pqr;
    expect(atoms.labels.size() == (is_named ? atoms.atoms.size() : 0), "atoms and their names");
    return {std::move(atoms.atoms), {}};
  } catch (const Error& error) {
    return {{}, checked_message(error, name)};
  }
}

bool same(const Outcome& a, const Outcome& b) {
  const auto same_atom = [](const Atom& one, const Atom& other) {
    return one.center == other.center && one.radius == other.radius;
  };
  return a.message == b.message &&
         std::equal(a.atoms.begin(), a.atoms.end(), b.atoms.begin(), b.atoms.end(), same_atom);
}

void expect_in_range(const Atom& atom) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    expect(std::fabs(atom.center[axis]) <= max_length, "a coordinate out of range");
  }
  expect(atom.radius >= 0 && atom.radius <= max_length, "a radius out of range");
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
  const Outcome outcome = read(text);
  expect(same(outcome, read(with_crlf(text))), "CRLF is read in another way than LF");
  if (!outcome.message.empty()) return;
  expect(!outcome.atoms.empty(), "neither atoms nor an error");
  for (const Atom& atom : outcome.atoms) expect_in_range(atom);
  expect(same(outcome, read(text_of(outcome.atoms))), "what is printed does not read back");
}

}  // namespace
}  // namespace eses::detail::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eses::detail::fuzz::check(eses::detail::fuzz::as_text(data, size));
  return 0;
}
