#include "expect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace eses::detail::fuzz {

void fail(std::string_view what) {
  fmt::print(stderr, "FAULT: {}\n", what);
  std::abort();
}

std::string checked_message(const Error& error, std::string_view name) {
  std::string message = error.what();
  const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
  if (!message.starts_with(name)) fail("a message that does not name the file: " + message);
  if (!std::all_of(message.begin(), message.end(), is_printable)) {
    fail("a message that is not one line of printable ASCII: " + message);
  }
  return message;
}

}  // namespace eses::detail::fuzz
