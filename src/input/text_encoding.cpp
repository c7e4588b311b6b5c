#include "input/text_encoding.hpp"

#include "eses/error.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

void refuse_wide_characters(std::string_view text, std::string_view name) {
  constexpr std::string_view little_32("\xff\xfe\0\0", 4), big_32("\0\0\xfe\xff", 4);
  std::string_view encoding;
  // The mark of UTF-32 begins with that of UTF-16.
  if (text.starts_with(little_32) || text.starts_with(big_32))
    encoding = "UTF-32";
  else if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    encoding = "UTF-16";
  if (!encoding.empty())
    throw Error(formatted("{}:1: {} text; convert the file to UTF-8 first", name, encoding));
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

}  // namespace eses::detail
