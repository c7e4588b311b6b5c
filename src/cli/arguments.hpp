#pragma once
/// Functions that the command lines of the program share: they add options and arguments to a
/// CLI11 application, parse the command line and word the messages.

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/usage.hpp"

namespace eses::detail::cli {

/// The texts of an option that are accepted, and their values.
template <class Value>
struct Format {
  std::function<std::optional<Value>(const std::string& text)> read;  ///< nothing: not accepted
  std::string expected;  ///< words for the message about other texts
};
template <class Value>
Format(std::optional<Value> (*)(const std::string&), const char*) -> Format<Value>;

/// Numbers in [min, max].
Format<double> number_between(double min, double max, std::string expected);

/// Whole numbers in [min, max].
Format<std::int64_t> whole_number_between(std::int64_t min, std::int64_t max);

/// Paths that are not empty.
Format<std::filesystem::path> path_to(std::string expected);

/// One of two or more names. CLI::CheckedTransformer would accept the numbers of the enumerators,
/// too, and CLI::IsMember words its message unlike the other options.
template <class Value>
Format<Value> one_of(const std::vector<std::pair<std::string, Value>>& choices) {
  std::string expected = choices.front().first;
  for (std::size_t i = 1; i < choices.size(); ++i)
    expected += (i + 1 < choices.size() ? ", " : " or ") + choices[i].first;
  const auto read = [choices](const std::string& text) {
    for (const auto& [name, value] : choices)
      if (name == text) return std::optional<Value>(value);
    return std::optional<Value>();
  };
  return {read, expected};
}

/// Reports that the value of an option or environment variable is not accepted: throws UsageError.
[[noreturn]] void refuse(std::string_view name, std::string_view value, std::string_view expected);

/// Sets `target` to the value of `option` when the command line is parsed. The conversions of CLI11
/// are not used: they accept NaN, hexadecimal and octal numbers, and round twice.
template <class Value, class Target>
CLI::Option* read_into(CLI::Option* option, Target& target, const Format<Value>& format) {
  return option->each([option, &target, format](const std::string& text) {
    const std::optional<Value> value = format.read(text);
    if (!value) refuse(option->get_name(), text, format.expected);
    target = static_cast<Target>(*value);
  });
}

/// Adds an option or, with a name without dashes, a positional argument.
template <class Value, class Target>
CLI::Option* add_value(CLI::App& app, const std::string& name, const std::string& value_name,
                       const std::string& description, Target& target,
                       const Format<Value>& format) {
  CLI::Option* const option = app.add_option(name)->option_text(value_name);
  return read_into(option->description(description), target, format);
}

/// Adds an option that takes no value.
CLI::Option* add_flag(CLI::App& app, const std::string& name, const std::string& description,
                      bool& target);

/// Sets the layout of the help; `usage` follows `Usage: `.
void set_up(CLI::App& app, std::string usage, std::string footer);

/// Adds --version and --help, which end the parsing at once.
void add_notices(CLI::App& app);

/// Parses the arguments that follow the program's name. `positionals` names those of `app`, for the
/// message about superfluous arguments. Returns the text that --help or --version asks for. Throws
/// UsageError.
std::optional<Notice> parse(CLI::App& app, std::vector<std::string> arguments,
                            std::string_view positionals);

/// The number that `text` spells from its first to its last character.
template <typename Number>
std::optional<Number> whole_text(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

}  // namespace eses::detail::cli
