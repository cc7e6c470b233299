#pragma once

#include <string_view>
#include <vector>

#include "core/motion/event.h"

namespace core {
struct Setup;
}
namespace gcode {
struct BlockCommands;
struct Lowering;
} // namespace gcode

namespace app {

/// The set-up's fixture moves that a block makes, by their indices.
std::vector<size_t> fixture_moves_of(const core::Setup& setup, const gcode::BlockCommands& block);

/// What a block does to the machine, in order: what the program says, and before and after it the
/// fixtures that the set-up moves.
///
/// `speed_by_hand`: a spindle that is started turns, whatever speed the program states.
std::vector<core::Event> events_of(const core::Setup& setup, const gcode::BlockCommands& block,
                                   gcode::Lowering& lowering, bool speed_by_hand);

/// Whether a block has the word M with this number outside of its comments.
bool has_m_code(std::string_view block, int code);

} // namespace app
