#pragma once
/// Commands for the user's file in messages. This header is valid C++17, for the reason given in
/// mmcif_text.cpp.

#include <string>
#include <string_view>

namespace eses::detail {

/// Returns an advice with the name of a file for the word FILE, and with its stem for FILE before
/// a suffix, as words of a shell. The word stays if the file is standard input.
std::string advice_for(std::string_view file, std::string_view advice);

}  // namespace eses::detail
