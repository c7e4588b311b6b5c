#pragma once
/// What the program's command lines have in common: options as text, texts as values, and messages
/// in our own words.

#include <CLI/CLI.hpp>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "cli/usage.hpp"

namespace eses::cli {

/// CLI11 shows this as nothing, and the empty string as its own `TEXT`.
inline constexpr char no_value_name[] = " ";

/// Gives a command line the look of its help, where `usage` stands behind `Usage: `.
void set_up(CLI::App& app, std::string usage);

/// Values are taken as text and converted by the functions below, so that every message can name
/// what is expected.
CLI::Option* add_value(CLI::App& app, const char* name, const char* value_name,
                       const std::string& description);

/// Parses the arguments that follow the program's name. Throws UsageError and CLI::CallForHelp.
void parse(CLI::App& app, std::vector<std::string> arguments);

/// Throws UsageError if there is more than options and what `positionals` names.
void refuse_extras(const CLI::App& app, std::string_view positionals);

/// The text given for an option, if any.
std::optional<std::string> text_of(const CLI::App& app, const std::string& name);

/// The text given for an option, or `fallback`; an empty text is refused.
std::string required_text(const CLI::App& app, const std::string& name, std::string fallback);

/// Whether a flag is given.
bool is_set(const CLI::App& app, const std::string& name);

/// What --version prints.
std::string version_text();

[[noreturn]] void refuse(std::string_view name, std::string_view value, std::string_view expected);

/// The number that `text` spells from its first to its last character.
template <typename Number>
std::optional<Number> whole_text(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

}  // namespace eses::cli
