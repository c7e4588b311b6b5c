#pragma once
/// What is odd in the input, in words and with line numbers.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/diagnostics.hpp"

namespace eses::detail::cli {

/// One kind of diagnostic.
struct DiagnosticText {
  struct Example {
    AtomIndex atom = 0;
    std::uint64_t line = 0;
    bool has_other = false;
    AtomIndex other_atom = 0;
    std::uint64_t other_line = 0;
    std::string label, other_label;  ///< such as A/LYS 33/CE; empty if unknown
  };
  std::string_view name;    ///< for programs, as in the JSON report
  bool is_usual = false;    ///< a note, not a warning
  std::uint64_t count = 0;  ///< atoms
  std::string short_text;   ///< behind the count, where notes are listed in one line
  std::string message;      ///< one line: file, count, what it is, the first few lines
  std::vector<Example> examples;
};

/// The line of an atom, one of the diagnostics' examples, in the input.
using LineOf = std::function<std::uint64_t(AtomIndex atom)>;

std::vector<DiagnosticText> describe(std::span<const Diagnostic> diagnostics, const LineOf& line_of,
                                     const std::filesystem::path& input,
                                     const std::map<AtomIndex, AtomLabel>& labels = {});

}  // namespace eses::detail::cli
