#pragma once
/// Common functions of the command lines: adding options and arguments to a CLI11 application,
/// parsing, and messages for usage errors.

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "system/read_number.hpp"

namespace eses::detail::cli {

/// The accepted texts of an option, and their values.
template <class Value>
struct Format {
  std::function<std::optional<Value>(const std::string& text)> read;  ///< empty if not accepted
  std::string expected;  ///< description for the message about other texts
};
template <class Value>
Format(std::optional<Value> (*)(const std::string&), const char*) -> Format<Value>;

/// Accepts numbers in [min, max].
Format<double> number_between(double min, double max, std::string expected);

/// Accepts lengths in [min, max] (angstrom).
Format<double> length_between(double min, double max);

/// Accepts whole numbers in [min, max].
Format<std::int64_t> whole_number_between(std::int64_t min, std::int64_t max);

/// Accepts the texts, such as paths, for which `is_accepted` returns true.
Format<std::string> text_if(bool (*is_accepted)(const std::string& text), std::string expected);

/// Accepts all texts that are not empty.
Format<std::string> any_text(std::string expected);

/// Accepts one of two or more names. CLI::CheckedTransformer would also accept the numbers of the
/// enumerators, and CLI::IsMember has messages in another form.
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

/// Returns the texts between the separators, one more than there are separators.
std::vector<std::string> split(std::string_view list, char separator);

/// Returns the names of a list such as `A,B`, or nothing if one is empty.
std::optional<std::vector<std::string>> names_in(const std::string& list);

/// Sets the members of `choice` that a list of names stands for, such as `atoms,chains`. A name may
/// stand for several members. Returns nothing if a name is unknown.
template <class Choice>
std::optional<Choice> choice_in(
    const std::string& list, Choice choice,
    const std::vector<std::pair<std::string_view, bool Choice::*>>& members) {
  for (const std::string& name : split(list, ',')) {
    bool is_known = false;
    for (const auto& [member_name, member] : members)
      if (member_name == name) choice.*member = is_known = true;
    if (!is_known) return std::nullopt;
  }
  return choice;
}

/// Throws UsageError for an unaccepted value of an option or environment variable.
[[noreturn]] void refuse(std::string_view name, std::string_view value, std::string_view expected);

/// Sets `target` to the value of `option` when the command line is parsed. Does not use CLI11's
/// conversions, which accept NaN, hexadecimal and octal numbers, and round twice.
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

/// Adds an option that takes no value and sets `target` to `value`.
template <class Target>
CLI::Option* add_flag(CLI::App& app, const std::string& name, const std::string& description,
                      Target& target, Target value = true) {
  CLI::Option* const flag = app.add_flag(name)->description(description);
  return flag->each([flag, &target, value](const std::string& text) {
    if (text != "true") throw UsageError(flag->get_name() + " takes no value");
    target = value;
  });
}

/// Sets the group, in the help, of the options that are added next.
void begin_group(CLI::App& app, const char* name);

/// The texts of the help of a command, beside its options.
struct HelpText {
  std::string usage;     ///< follows `Usage: `
  std::string examples;  ///< three command lines with their meanings, shown first
  std::string details;   ///< files, exit codes and so on
  /// The options in --help. --help-all has all options and the details. If the list is empty,
  /// --help has them, too.
  std::vector<std::string> common = {};
};

/// Sets the layout of the help.
void set_up(CLI::App& app, HelpText text);

/// Returns the text of --version.
std::string version_text();

/// Adds --version, --help and --help-all, which stop the parsing.
void add_notices(CLI::App& app);

/// Parses the arguments of a command. `positionals` has the names of the positional arguments, for
/// the message about superfluous ones. Throws UsageError, or Notice for help and version.
void parse(CLI::App& app, const Arguments& arguments, std::string_view positionals);

/// Returns the options that were given, except `left_out`: a line `NAME: VALUES` for each.
std::string given_options(const CLI::App& app, std::initializer_list<std::string_view> left_out);

/// Throws UsageError if one of these options is given without something that it needs.
void refuse_without(const CLI::App& app, std::initializer_list<const char*> options,
                    bool has_needed, std::string_view needed);

/// Returns the number that is the whole of `text`, or nothing if `text` is not a number.
template <typename Number>
std::optional<Number> whole_text(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = read_number(text, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

}  // namespace eses::detail::cli
