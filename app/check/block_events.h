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

/// The indices of the set-up's fixture moves that a block triggers.
std::vector<size_t> fixture_moves_of(const core::Setup& setup, const gcode::BlockCommands& block);

/// The events of a block in order: those of the program, with the fixture moves of the set-up
/// before and after them.
///
/// `speed_by_hand`: a started spindle turns even if the program states no speed.
std::vector<core::Event> events_of(const core::Setup& setup, const gcode::BlockCommands& block,
                                   gcode::Lowering& lowering, bool speed_by_hand);

/// Whether a block has this M code outside comments.
bool has_m_code(std::string_view block, int code);

} // namespace app
