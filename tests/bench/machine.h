#pragma once

#include <string>
#include <utility>
#include <vector>

namespace bench {

/// What the results were measured on and with, as name and value: processor, cores, compiler,
/// vector instructions, versions of the peers.
std::vector<std::pair<std::string, std::string>> machine();

} // namespace bench
