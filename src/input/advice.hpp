#pragma once
/// Advice in messages: commands for the file of the user, and the name that was probably meant.
/// This header is valid C++17, for the reason given in mmcif_text.cpp.

#include <string>
#include <string_view>
#include <vector>

namespace eses::detail {

/// Returns an advice with the name of a file for the word FILE, and with its stem for FILE before
/// a suffix, as words of a shell. The word stays if the file is standard input.
std::string advice_for(std::string_view file, std::string_view advice);

/// Returns the name that was probably meant: one that begins with the word, or one that differs
/// from it by at most two letters; empty if there is none.
std::string_view closest_name(std::string_view word, const std::vector<std::string>& names);

}  // namespace eses::detail
