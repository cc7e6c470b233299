#pragma once

#include <string>

#include "app/debug/prompt/prompt.h"

namespace core {
struct BlockResult;
struct Setup;
} // namespace core

namespace app {

struct CheckedBlock;

/// Where the session stands, for a person: the block that is next, how near it comes, what was
/// found about it, and the displays. Behind the last block, how the program ended.
std::string place_text(PromptState& state);

/// Why a walk ended, with a newline; empty where it went as far as was asked.
std::string stop_text(const PromptState& state, const Stop& stop);

/// "0.420 mm", "0.401-0.420 mm", "more than 50 mm", "not known".
std::string clearance_text(const core::Setup& setup, const core::BlockResult& result);

/// "line 23", "line 23 of sub.nc".
std::string line_text(const CheckedBlock& block);

/// A finding with its cure, in lines of at most 80 characters.
std::string finding_text(const core::Finding& finding, size_t indent);

/// A value of the control before the block at the place, or of that block.
///
/// Errors: as value_of and evaluate.
core::Result<InspectedValue> value_here(PromptState& state, const std::string& expression);

/// The displays with their values, a line each.
std::string displays_text(PromptState& state);

/// What a question about the place is asked about.
Condition::Subject subject_of(const PromptState& state);

/// Whether the block at the place is known; false at the end of the program.
bool has_block(PromptState& state);

} // namespace app
