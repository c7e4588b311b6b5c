#include "cli/arguments.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

#include "eses/version.hpp"
#include "input/advice.hpp"
#include "input/read_structure.hpp"
#include "input/text_fields.hpp"
#include "system/dispatch.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

constexpr int left_column = 28;  ///< characters, of the names of options

/// Formats the help. CLI11 formats options and paragraphs differently since its version 2.5.
class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(HelpText text) : text_(std::move(text)) {}

  std::string make_help(const CLI::App* app, std::string /*name*/,
                        CLI::AppFormatMode mode) const override {
    const bool is_short = !text_.common.empty() && mode != CLI::AppFormatMode::All;
    std::string help = formatted("{}\n\nUsage: {}\n\nExamples:\n{}\n", app->get_description(),
                                 text_.usage, text_.examples);
    help += group_text("Arguments", app->get_options([](const CLI::Option* option) {
      return !option->get_group().empty() && option->get_positional();
    }));
    for (const std::string& group : app->get_groups())
      help += group_text(group, app->get_options([&](const CLI::Option* option) {
        return option->get_group() == group && option->nonpositional() &&
               (!is_short || is_common(option->get_name()));
      }));
    return help + "\n" +
           (is_short ? formatted("More options, all files and exit codes: {} --help-all\n",
                                 app->get_name())
                     : text_.details + "\n");
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    const std::string indent(left_column, ' ');
    const std::string names =
        "  " + make_option_name(option, is_positional) + make_option_opts(option);
    const std::string gap =
        names.size() < indent.size() ? indent.substr(names.size()) : "\n" + indent;
    return names + gap + replaced(option->get_description(), "\n", "\n" + indent) + "\n";
  }
  // Writes names in the usual form, `-o, --output-dir`, without the `{N}` that CLI11 appends to a
  // flag with an optional value.
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    const std::string name = CLI::Formatter::make_option_name(option, is_positional);
    return replaced(name.substr(0, name.find('{')), ",", ", ");
  }
  // Writes only the name of the value. The value of a flag follows without a blank.
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string& text = option->get_option_text();
    return text.empty() || text.starts_with("[=") ? text : " " + text;
  }

 private:
  bool is_common(const std::string& option) const {
    return std::ranges::find(text_.common, option) != text_.common.end();
  }
  /// Returns the heading and the options of a group; nothing if it has no options.
  std::string group_text(const std::string& group,
                         const std::vector<const CLI::Option*>& options) const {
    if (options.empty()) return {};
    std::string text = formatted("\n{}:\n", group);
    for (const CLI::Option* option : options) text += make_option(option, option->get_positional());
    return text;
  }

  HelpText text_;
};

/// Returns whether a text looks like an option, which may be mistyped. Negative numbers do not.
bool has_form_of_option(const std::string& text) {
  return text.size() > 1 && text[0] == '-' && (text[1] == '-' || is_letter(text[1]));
}

/// Throws UsageError where CLI11 would take the next argument for a missing value: after `--name=`,
/// and before another option, as in `--surface --write none`.
void refuse_missing_values(CLI::App& app, const Arguments& arguments) {
  for (std::size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
    const std::string& name = arguments[i];
    if (name.starts_with("--") && name.ends_with('='))
      throw UsageError(formatted("{} needs a value", name));
    const auto option_named = [&](const std::string& text) {
      return text.starts_with('-') ? app.get_option_no_throw(text) : nullptr;
    };
    CLI::Option* const option = option_named(name);
    if (option == nullptr || option->get_items_expected_min() == 0 || i + 1 == arguments.size())
      continue;
    const std::string& value = arguments[i + 1];
    if (option_named(value) == nullptr && !has_form_of_option(value)) continue;
    option->add_result(value);
    option->run_callback();  // throws with what it expects, unless it accepts all texts
    const std::string equal_sign = name.starts_with("--") ? "=" : "";  // as in -oVALUE
    throw UsageError(formatted("{0} needs a value before {1}; for the text '{1}', write {0}{2}{1}",
                               name, value, equal_sign));
  }
}

/// Options of another command or program, separated by blanks, and what has their place here.
struct ForeignOptions {
  std::string_view names, advice;
};
constexpr std::array foreign_options{
    ForeignOptions{"--cavities --pockets --at --parts --report --table --csv --large-probe",
                   "it is an option of 'eses-blocks measure'"},
    ForeignOptions{"--groups --ligand", "it is an option of 'eses-blocks interface'"},
    ForeignOptions{"--mesh --color", "it is an option of 'eses-blocks FILE', without a command"},
    ForeignOptions{"--rsa",
                   "relative areas of residues are printed by 'eses-blocks measure FILE --table "
                   "residues' or, as NACCESS does, '--table rsa'"},
    ForeignOptions{"--depth",
                   "areas by chain, residue or atom are printed by 'eses-blocks measure FILE "
                   "--table chains', 'residues' or 'atoms'"},
};

/// Returns what to do instead of giving an unknown option.
std::string advice_for_option(const CLI::App& app, const std::string& extra) {
  std::error_code ignored;
  if (std::filesystem::exists(extra, ignored)) return "; put a file of this name after --";
  const std::string name = extra.substr(0, extra.find('='));
  for (const ForeignOptions& foreign : foreign_options)
    if (has_word(foreign.names, name)) return formatted("; {}", foreign.advice);
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& known : option->get_lnames()) names.push_back("--" + known);
  if (const std::string_view meant = closest_name(name, names); !meant.empty())
    return formatted("; did you mean {}?", meant);
  return "";
}

[[noreturn]] void refuse_extra(const CLI::App& app, const std::string& extra,
                               std::string_view positionals) {
  if (!extra.starts_with('-'))
    throw UsageError(formatted("unexpected argument '{}' after {}", extra, positionals));
  // CLI11 recognizes `-1` as a number, but treats `-.5` and `-inf` as options.
  if (whole_text<double>(extra))
    throw UsageError(formatted("unexpected negative number '{}' among {}", extra, positionals));
  throw UsageError(formatted("unknown option '{}'{}", extra, advice_for_option(app, extra)));
}

void refuse_extras(const CLI::App& app, std::string_view positionals) {
  for (const std::string& extra : app.remaining())
    if (extra != "--") refuse_extra(app, extra, positionals);
}

/// Returns the message for an option with too many values or, which is possible only for the last
/// argument, with no value.
std::string mismatch_message(const CLI::App& app, const std::string& last) {
  for (const CLI::Option* option : app.get_options())
    if (option->get_multi_option_policy() == CLI::MultiOptionPolicy::Throw && option->count() > 1)
      return formatted("{} is given more than once", option->get_name());
  return formatted("{} needs a value", last);
}

/// Parses with CLI11 and converts all its errors to UsageError.
void parse_or_refuse(CLI::App& app, Arguments arguments) {
  const std::string last = arguments.empty() ? "" : arguments.back();
  std::reverse(arguments.begin(), arguments.end());  // CLI11 expects them in reverse order
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::Success&) {
    throw;
  } catch (const CLI::ArgumentMismatch&) {
    throw UsageError(mismatch_message(app, last));
  } catch (const CLI::RequiresError& error) {
    throw UsageError(replaced(error.what(), " requires ", " needs "));
  } catch (const CLI::ExcludesError& error) {
    throw UsageError(formatted("{}; use only one of them", error.what()));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace

Format<double> number_between(double min, double max, std::string expected) {
  const auto read = [min, max](const std::string& text) {
    const std::optional<double> value = whole_text<double>(text);
    // NaN is not in any range.
    return value && *value >= min && *value <= max ? value : std::nullopt;
  };
  return {read, std::move(expected)};
}

Format<double> length_between(double min, double max) {
  return number_between(min, max, formatted("a number from {} to {}, in angstrom", min, max));
}

Format<std::int64_t> whole_number_between(std::int64_t min, std::int64_t max) {
  const auto read = [min, max](const std::string& text) {
    const std::optional<std::int64_t> value = whole_text<std::int64_t>(text);
    return value && *value >= min && *value <= max ? value : std::nullopt;
  };
  return {read, formatted("a whole number from {} to {}", min, max)};
}

Format<std::string> text_if(bool (*is_accepted)(const std::string& text), std::string expected) {
  const auto read = [is_accepted](const std::string& text) {
    return is_accepted(text) ? std::optional(text) : std::nullopt;
  };
  return {read, std::move(expected)};
}

Format<std::string> any_text(std::string expected) {
  return text_if([](const std::string& text) { return !text.empty(); }, std::move(expected));
}

std::vector<std::string> split(std::string_view list, char separator) {
  std::vector<std::string> parts;
  std::size_t end = 0;
  while ((end = list.find(separator)) != list.npos) {
    parts.emplace_back(list.substr(0, end));
    list.remove_prefix(end + 1);
  }
  parts.emplace_back(list);
  return parts;
}

std::optional<std::vector<std::string>> names_in(const std::string& list) {
  std::vector<std::string> names = split(list, ',');
  return std::ranges::count(names, "") > 0 ? std::nullopt : std::optional(std::move(names));
}

void refuse(std::string_view name, std::string_view value, std::string_view expected) {
  throw UsageError(formatted("{} is '{}', expected {}", name, value, expected));
}

void begin_group(CLI::App& app, const char* name) { app.option_defaults()->group(name); }

void set_up(CLI::App& app, HelpText text) {
  if (!text.common.empty())
    text.common.insert(text.common.end(), {"--version", "--help", "--help-all"});
  app.formatter(std::make_shared<HelpFormatter>(std::move(text)));
  app.allow_extras();  // refuse_extras() gives better messages
  app.set_help_flag();
  begin_group(app, "Options");
}

std::string version_text() {
  const std::string_view gemmi = gemmi_version();
  const std::string formats = gemmi.empty()
                                  ? "xyzr and PQR (built without gemmi)"
                                  : formatted("xyzr, PQR, PDB and mmCIF (gemmi {})", gemmi);
  return formatted(
      "eses-blocks {}\ncompiler: {}\nbuild type: {}\nflags: {}\ninstruction set: {}\nreads: {}\n",
      version, compiler, build_type, compiler_flags, name_of(instruction_set()), formats);
}

void add_notices(CLI::App& app) {
  app.set_version_flag("--version", version_text, "print version and build information")
      ->trigger_on_parse();
  app.add_flag_callback(
         "-h,--help", [] { throw CLI::CallForHelp(); }, "print this help")
      ->trigger_on_parse();
  app.add_flag_callback(
         "--help-all", [] { throw CLI::CallForAllHelp(); }, "print the help with all options")
      ->trigger_on_parse();
}

void parse(CLI::App& app, const Arguments& arguments, std::string_view positionals) {
  refuse_missing_values(app, arguments);
  try {
    parse_or_refuse(app, arguments);
  } catch (const CLI::CallForHelp&) {
    throw Notice{app.help()};
  } catch (const CLI::CallForAllHelp&) {
    throw Notice{app.help("", CLI::AppFormatMode::All)};
  } catch (const CLI::CallForVersion& notice) {
    throw Notice{notice.what()};
  } catch (const UsageError&) {
    // The value of an unknown option is parsed as a positional argument, so the unknown option is
    // reported instead of an error in that argument.
    refuse_extras(app, positionals);
    throw;
  }
  refuse_extras(app, positionals);
}

std::string given_options(const CLI::App& app, std::initializer_list<std::string_view> left_out) {
  std::string text;
  for (const CLI::Option* const option : app.get_options()) {
    const std::string name = option->get_name();
    const bool is_left_out = std::ranges::find(left_out, name) != left_out.end();
    if (option->count() == 0 || option->get_positional() || is_left_out) continue;
    text += name + ":";
    for (const std::string& value : option->results())
      text +=
          formatted(" {} {}", value.size(), replaced(replaced(value, "\\", "\\\\"), "\n", "\\n"));
    text += "\n";
  }
  return text;
}

void refuse_without(const CLI::App& app, std::initializer_list<const char*> options,
                    bool has_needed, std::string_view needed) {
  if (has_needed) return;
  for (const char* const option : options)
    if (app.count(option) > 0) throw UsageError(formatted("{} needs {}", option, needed));
}

}  // namespace eses::detail::cli
