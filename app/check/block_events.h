#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/motion/event.h"

namespace core {
struct Judgement;
struct Setup;
struct SimulatorState;
} // namespace core
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

/// The first axis besides X, Y and Z that moves or is away from 0, not counting full turns; empty
/// if there is none.
std::optional<size_t> displaced_axis(std::span<const core::Event> events);

/// Receives a block and its events. Returns false to see no more blocks.
using BlockVisit = std::function<bool(const gcode::BlockCommands&, std::span<const core::Event>)>;

/// Why nothing can be proven about a block, whatever its events are; empty if something can.
/// `has_axes`: the set-up describes the axes of the machine.
std::string doubt_about(const gcode::BlockCommands& block, std::span<const core::Event> events,
                        bool has_axes);

/// A block that has not run yet.
struct NextBlock {
    std::vector<core::Event> events;
    std::string doubt; // see doubt_about()
};

/// The first block that `show` passes to its visitor; empty if there is none.
std::optional<NextBlock> first_block(const std::function<void(const BlockVisit&)>& show,
                                     bool has_axes);

/// Judges a block in place of the distance core: its events, with the state before them, and the
/// doubt about it.
using BlockJudge = std::function<core::Result<core::Judgement>(
    std::span<const core::Event>, const core::SimulatorState&, const std::string&)>;

/// Whether a block has this M code outside comments.
bool has_m_code(std::string_view block, int code);

} // namespace app
