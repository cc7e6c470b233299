#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace test_support {

/// A zip archive of these files, stored without packing; `flags` of each file, 1 is encrypted.
std::string zip_of(const std::vector<std::pair<std::string, std::string>>& files,
                   uint16_t flags = 0);

/// The same packed.
std::string packed_zip_of(const std::vector<std::pair<std::string, std::string>>& files);

} // namespace test_support
