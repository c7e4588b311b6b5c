#include "input/text_encoding.hpp"

#include "eses/error.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

void refuse_utf16(std::string_view text, std::string_view name) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw Error(formatted("{}:1: UTF-16 text; convert the file to UTF-8 first", name));
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

}  // namespace eses::detail
