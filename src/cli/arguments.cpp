#include "cli/arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "eses/version.hpp"
#include "simd/dispatch.hpp"

namespace eses::cli {
namespace {

class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(std::string usage) : usage_(std::move(usage)) {
    label("Positionals", "Arguments");
    column_width(28);
  }
  std::string make_usage(const CLI::App* /*app*/, std::string /*name*/) const override {
    return fmt::format("\nUsage: {}\n", usage_);
  }
  // As other programs have it: `-o, --output-dir`.
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    return CLI::detail::find_and_replace(CLI::Formatter::make_option_name(option, is_positional),
                                         ",", ", ");
  }
  // The value of a flag follows without a blank.
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string text = option->get_option_text();
    return text.starts_with("[=") ? text : CLI::Formatter::make_option_opts(option);
  }
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    const std::string help = CLI::Formatter::make_help(app, std::move(name), mode);
    return CLI::detail::find_and_replace(help, "\n\n\n", "\n\n");
  }

 private:
  std::string usage_;
};

/// CLI11 would take the next argument as the value of `--name=`.
void refuse_empty_values(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") return;
    if (argument.starts_with("--") && argument.ends_with('=')) {
      throw UsageError(fmt::format("{} needs a value", argument));
    }
  }
}

[[noreturn]] void refuse_extra(const std::string& extra, std::string_view positionals) {
  if (!extra.starts_with('-')) {
    throw UsageError(fmt::format("unexpected argument '{}' after {}", extra, positionals));
  }
  std::error_code ignored;
  const bool is_file = std::filesystem::exists(extra, ignored);
  throw UsageError(fmt::format("unknown option '{}'{}", extra,
                               is_file ? "; the file of that name goes after --" : ""));
}

// Not by CLI::App::get_option, which looks options up in a function that is noexcept: where memory
// runs out there, the process is ended.
const std::vector<std::string>& results_of(const CLI::App& app, const std::string& name) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->check_name(name)) return option->results();
  }
  throw CLI::OptionNotFound(name);
}

}  // namespace

void set_up(CLI::App& app, std::string usage) {
  app.formatter(std::make_shared<HelpFormatter>(std::move(usage)));
  app.allow_extras();  // `refuse_extras` does that, in our own words
}

CLI::Option* add_value(CLI::App& app, const char* name, const char* value_name,
                       const std::string& description) {
  return app.add_option(name)
      ->option_text(value_name)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->description(description);
}

void parse(CLI::App& app, std::vector<std::string> arguments) {
  refuse_empty_values(arguments);
  const std::string last = arguments.empty() ? "" : arguments.back();
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::ArgumentMismatch&) {
    // Values are eaten whatever they look like, so only the last option can lack one.
    throw UsageError(fmt::format("{} needs a value", last));
  } catch (const CLI::CallForHelp&) {
    throw;
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
}

void refuse_extras(const CLI::App& app, std::string_view positionals) {
  for (const std::string& extra : app.remaining()) {
    if (extra != "--") refuse_extra(extra, positionals);
  }
}

std::optional<std::string> text_of(const CLI::App& app, const std::string& name) {
  const std::vector<std::string>& results = results_of(app, name);
  if (results.size() > 1) throw UsageError(fmt::format("{} is given more than once", name));
  if (results.empty()) return std::nullopt;
  return results.front();
}

std::string required_text(const CLI::App& app, const std::string& name, std::string fallback) {
  std::string text = text_of(app, name).value_or(std::move(fallback));
  if (text.empty()) throw UsageError(fmt::format("{} is missing", name));
  return text;
}

bool is_set(const CLI::App& app, const std::string& name) {
  const std::vector<std::string>& results = results_of(app, name);
  for (const std::string& result : results) {
    if (result != "true") throw UsageError(fmt::format("{} takes no value", name));
  }
  return !results.empty();
}

void refuse(std::string_view name, std::string_view value, std::string_view expected) {
  throw UsageError(fmt::format("{} is '{}', expected {}", name, value, expected));
}

std::string version_text() {
  return fmt::format(
      "eses-blocks {}\ncompiler: {}\nbuild type: {}\nflags: {}\ninstruction set: {}\n", version,
      compiler, build_type, compiler_flags, name_of(instruction_set()));
}

}  // namespace eses::cli
