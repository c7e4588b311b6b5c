#pragma once
/// Texts that identify a run, so that kept results are not combined with those of another run. Such
/// a text has a line `NAME: VALUE` for each property that the results depend on, and begins with
/// the version of the program.

#include <string>
#include <string_view>

#include "system/formatted.hpp"

namespace eses::detail {

/// Adds a property of a run to its identity.
template <class Value>
void add_property(std::string& identity, std::string_view name, const Value& value) {
  identity += formatted("{}: {}\n", name, value);
}

/// Returns the names of the properties in which two runs differ, for messages. If the versions
/// differ, returns only the name of that line, as the others may have another form.
std::string differing_names(std::string_view identity, std::string_view other);

}  // namespace eses::detail
