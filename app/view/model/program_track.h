#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "app/view/model/block_row.h"
#include "core/base/result.h"
#include "core/motion/event.h"
#include "render/tool_path.h"

namespace core {
struct Machine;
} // namespace core

namespace gcode {
struct BlockCommands;
} // namespace gcode

namespace app {
struct PreparedCheck;
} // namespace app

namespace app::viewer {

/// Largest deviation of drawn chords from arcs, mm: less than a pixel.
constexpr double drawing_error = 0.02;

/// A program before it is checked: its blocks in order and the path of the tool tip.
///
/// Frame: the path is in the frame of the stock.
class ProgramTrack {
public:
    /// Starts at block `first` with `tool` in the spindle. The set-up must outlive the track.
    explicit ProgramTrack(const core::Setup& setup, size_t first = 0,
                          std::optional<core::ToolNumber> tool = {});

    /// Adds the next block. Returns false if the track is full: blocks after some millions are only
    /// known once they are checked.
    bool add(const gcode::BlockCommands& block, std::span<const core::Event> events);

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

/// The track of a program before its stock is modelled, up to its end or first error, or until
/// `is_closing` returns true. The set-up must outlive it.
ProgramTrack track_of(const PreparedCheck& check, const core::Setup& setup,
                      const std::function<bool()>& is_closing);

/// Why a program has no block that can be executed; empty if it has one.
std::optional<core::Error> why_nothing_runs(const PreparedCheck& check);

/// The values of all axes, 0 for axes that the machine lacks; empty if one is unknown.
std::optional<core::AxisValues> known_values(const core::Machine& machine,
                                             const core::AxisPosition& position);

} // namespace app::viewer
