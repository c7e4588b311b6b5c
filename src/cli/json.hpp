#pragma once
/// JSON documents as text (RFC 8259).

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "system/formatted.hpp"

namespace eses::detail::cli::json {

/// A JSON value that keeps the order of its keys.
using Value = nlohmann::ordered_json;

/// Returns the text of `value`, with `separator` between the members of the outermost object.
///
/// Numbers have the shortest text that is parsed as the same number. (The text of nlohmann::json is
/// longer for one number in 1500, and ends with `.0` for whole numbers.) Infinity and NaN become
/// null. Bytes that are not UTF-8, such as in file names, become U+FFFD.
inline std::string text_of(const Value& value, std::string_view separator = ", ") {
  if (value.is_number_float() && std::isfinite(value.get<double>()))
    return formatted("{}", value.get<double>());
  if (!value.is_structured()) return value.dump(-1, ' ', false, Value::error_handler_t::replace);
  std::string text;
  for (const auto& [key, item] : value.items()) {
    if (!text.empty()) text += separator;
    if (value.is_object()) text += text_of(key) + ": ";
    text += text_of(item);
  }
  return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

/// Returns the array of `make(item)` for the items of a list.
template <class Items, class Make>
Value array_of(const Items& items, Make&& make) {
  Value array = Value::array();
  for (const auto& item : items) array.push_back(make(item));
  return array;
}

}  // namespace eses::detail::cli::json
