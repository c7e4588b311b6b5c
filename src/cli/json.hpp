#pragma once
/// JSON documents (RFC 8259) with nlohmann::json, which converts a type by its function `to_json`.

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "eses/vec3.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

/// A JSON value that keeps the order of its keys.
using Json = nlohmann::ordered_json;

}  // namespace eses::detail

/// Converts a missing value to null.
template <class Value>
struct nlohmann::adl_serializer<std::optional<Value>> {
  static void to_json(eses::detail::Json& json, const std::optional<Value>& value) {
    json = value ? eses::detail::Json(*value) : eses::detail::Json();
  }
};

namespace eses {

inline void to_json(detail::Json& json, const Vec3& vector) {
  json = {vector.x, vector.y, vector.z};
}

}  // namespace eses

namespace eses::detail::cli {

/// Returns the text of `value`, with `separator` between the members of the outermost object.
///
/// Numbers have the shortest text that is parsed as the same number. (The text of nlohmann::json is
/// longer for one number in 1500, and ends with `.0` for whole numbers.) Infinity and NaN become
/// null. Bytes that are not UTF-8, such as in file names, become U+FFFD.
inline std::string text_of(const Json& value, std::string_view separator = ", ") {
  if (value.is_number_float() && std::isfinite(value.get<double>()))
    return formatted("{}", value.get<double>());
  if (!value.is_structured()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (const auto& [key, item] : value.items()) {
    if (!text.empty()) text += separator;
    if (value.is_object()) text += text_of(Json(key)) + ": ";
    text += text_of(item);
  }
  return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

}  // namespace eses::detail::cli
