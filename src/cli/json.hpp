#pragma once
/// JSON documents as text (RFC 8259).

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace eses::detail::cli::json {

/// Keeps the order of its keys.
using Value = nlohmann::ordered_json;

/// The text of `value`, with `separator` between the members of the outermost object only.
///
/// Numbers are the shortest text that reads back as the same number. nlohmann's own text is longer
/// for one number in 1500, and ends with `.0` for whole numbers. Infinity and NaN become null.
/// Bytes that are not UTF-8, which file names may hold, become U+FFFD.
inline std::string text_of(const Value& value, std::string_view separator = ", ") {
  if (value.is_number_float() && std::isfinite(value.get<double>()))
    return fmt::format("{}", value.get<double>());
  if (!value.is_structured()) return value.dump(-1, ' ', false, Value::error_handler_t::replace);
  std::string text;
  for (const auto& [key, item] : value.items()) {
    if (!text.empty()) text += separator;
    if (value.is_object()) text += text_of(key) + ": ";
    text += text_of(item);
  }
  return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

}  // namespace eses::detail::cli::json
