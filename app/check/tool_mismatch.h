#pragma once

#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/sim/finding.h"

namespace gcode {
struct Program;
}

namespace app {

struct FeedFacts;
struct SetupFile;

/// A tool whose description in a comment of the program contradicts that in the set-up.
struct ToolMismatch {
    core::ToolNumber tool{};
    bool is_larger = false; // the tool in the comment is the larger one, so crashes may be missed
    std::string message;
};

/// Compares the tools stated in a set-up with those that comments of the program describe:
/// diameters that differ by more than regrinding explains, and shapes that cannot be meant for each
/// other. `file` still holds its set-up.
std::vector<ToolMismatch> tool_mismatches(const gcode::Program& program, const SetupFile& file);

/// The findings `tool-mismatch`, for the tools that feed; warnings where the tool in the comment is
/// not the larger one.
std::vector<core::Finding> findings_of(const std::vector<ToolMismatch>& mismatches,
                                       const FeedFacts& facts, const core::Setup& setup);

} // namespace app
