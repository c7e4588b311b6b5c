#pragma once
/// The name that a user probably meant.

#include <span>
#include <string>
#include <string_view>

namespace eses::detail {

/// Returns the name that was probably meant: one that begins with the word, or one that differs
/// from it by at most two letters; empty if there is none.
std::string_view closest_name(std::string_view word, std::span<const std::string> names);

}  // namespace eses::detail
