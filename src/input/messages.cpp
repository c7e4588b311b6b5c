#include "input/messages.hpp"

#include <algorithm>

#include "input/text_fields.hpp"

namespace eses::detail {

std::string reworded(std::string_view text) {
  // The caller adds file and line.
  if (text.starts_with("Problem in line "))
    text.remove_prefix(std::min(text.size(), text.find(':') + 2));
  while (text.ends_with('.') || text.ends_with(':') || text.ends_with(' ') || text.ends_with('\n'))
    text.remove_suffix(1);
  std::string message(text);
  std::replace(message.begin(), message.end(), '\n', ' ');
  // Words in capital letters are names of records.
  if (message.size() > 1 && message[1] == lower_case(message[1]))
    message[0] = lower_case(message[0]);
  return printable(message);
}

}  // namespace eses::detail
