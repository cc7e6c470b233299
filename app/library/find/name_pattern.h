#pragma once

#include <string>

namespace app {

/// Whether a file name matches a pattern with `*`, `?`, `[...]` and, before a character that is
/// meant as it is, `\`. Sets contain characters, ranges and the classes of POSIX, such as
/// `[[:digit:]]`, of ASCII letters. A leading dot has to be written. Upper and lower case differ
/// where they do in file names. Both are UTF-8; a byte that is not counts as a character.
///
/// Cost:    the product of the lengths, unless the pattern has a `[` that is not closed.
bool matches_pattern(const std::string& pattern, const std::string& name);

} // namespace app
