#include "output/identity.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) lines.push_back(take_line(text));
  return lines;
}

std::string_view name_of(std::string_view line) { return line.substr(0, line.find(": ")); }

}  // namespace

std::string differing_names(std::string_view identity, std::string_view other) {
  const std::vector<std::string_view> lines = lines_of(identity), others = lines_of(other);
  if (lines.empty() || others.empty() || lines.front() != others.front())
    return std::string(name_of(lines.empty() ? "" : lines.front()));
  std::vector<std::string_view> names;
  const auto add_missing = [&](const auto& from, const auto& in) {
    for (const std::string_view line : from)
      if (std::ranges::find(in, line) == in.end() &&
          std::ranges::find(names, name_of(line)) == names.end())
        names.push_back(name_of(line));
  };
  add_missing(lines, others);
  add_missing(others, lines);
  return formatted("{}", fmt::join(names, ", "));
}

}  // namespace eses::detail
