#pragma once

#include <string>
#include <utility>
#include <vector>

namespace bench {

/// The environment of the measurements as names and values: processor, cores, compiler, vector
/// instructions, versions of the libraries.
std::vector<std::pair<std::string, std::string>> machine();

} // namespace bench
