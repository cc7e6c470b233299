#pragma once

#include <string>

#include "app/debug/prompt/prompt.h"

namespace core {
struct BlockResult;
struct Setup;
} // namespace core

namespace app {

struct CheckedBlock;

/// The position of the session: the next block, its clearance and findings, and the displays. After
/// the last block: how the program ended.
std::string location_text(PromptState& state);

/// Why a walk stopped, with a newline; empty if it ran the requested number of blocks.
std::string stop_text(const PromptState& state, const Stop& stop);

/// The location of a block: "line 23", "line 23 of sub.nc".
std::string line_text(const CheckedBlock& block);

/// A finding with its cure, in lines of at most 80 characters.
std::string finding_text(const core::Finding& finding, size_t indent);

/// The value of an expression: of the control before the next block, or of that block.
///
/// Errors: as value_of and evaluate.
core::Result<InspectedValue> value_here(PromptState& state, const std::string& expression);

/// The displayed expressions with their values, one per line.
std::string displays_text(PromptState& state);

/// The next block as the subject of a condition.
Condition::Subject subject_of(const PromptState& state);

/// Whether there is a next block; false at the end of the program.
bool has_block(PromptState& state);

} // namespace app
