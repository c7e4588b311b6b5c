#pragma once
/// What every target needs: its entry, and a way to say that something is wrong.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "eses/error.hpp"

/// One input; defined by each target, called by libFuzzer or by the main that replays a corpus.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace eses::detail::fuzz {

/// Ends the process, which is how libFuzzer notices a finding.
[[noreturn]] void fail(std::string_view what);

inline void expect(bool holds, std::string_view what) {
  if (!holds) fail(what);
}

/// The message, which must be one line of printable ASCII that begins with the file's name.
std::string checked_message(const Error& error, std::string_view name);

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace eses::detail::fuzz
