#pragma once

#include <span>

#include "app/view/model/block_row.h"
#include "core/motion/event.h"
#include "render/tool_path.h"

namespace core {
struct Machine;
} // namespace core

namespace gcode {
struct BlockResult;
} // namespace gcode

namespace app::viewer {

/// Chords of arcs are drawn within this of them, mm: less than a pixel.
constexpr double drawing_error = 0.02;

/// What is known of a program before it is checked: its blocks in order and the way of the tip.
///
/// Frame: path in that of the stock.
class ProgramTrack {
public:
    /// The set-up must outlive it. It begins at block `first`, with this tool in the spindle.
    explicit ProgramTrack(const core::Setup& setup, size_t first = 0,
                          std::optional<core::ToolNumber> tool = {});

    /// Adds the next block.
    void add(const gcode::BlockCommands& block, std::span<const core::Event> events);

    std::vector<BlockRow> rows;
    std::vector<render::PathPoint> points;

private:
    void add_motion(const core::Motion& motion, BlockRow& row);
    double tool_length() const;

    const core::Setup& setup_;
    size_t first_;
    std::optional<core::ToolNumber> tool_;
    double time_ = 0.0;
};

/// The values of all axes, those that the machine lacks at 0; empty where one may stand anywhere.
std::optional<core::AxisValues> known_values(const core::Machine& machine,
                                             const core::AxisPosition& position);

} // namespace app::viewer
