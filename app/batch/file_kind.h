#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace app {

/// Why a file that nobody named is not taken for an NC program: "is a mesh"; empty for a program.
///
/// Nobody who listens is told.
///
/// Errors: io when it cannot be read.
/// Cost:   its first 64 KB are read at most; nothing where the name's ending tells.
core::Result<std::optional<std::string>> why_no_program(const std::string& path);

/// The same by the first part of a text alone.
std::optional<std::string> why_no_program_text(std::string_view text);

} // namespace app
