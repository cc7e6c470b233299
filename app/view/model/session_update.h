#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "app/debug/condition.h"
#include "app/view/model/block_row.h"
#include "core/motion/event.h"
#include "core/sim/verdict.h"
#include "render/stock_brick.h"
#include "render/tool_path.h"

namespace core {
struct Machine;
} // namespace core
namespace gcode {
struct Offsets;
} // namespace gcode
namespace render {
class SurfaceMaker;
} // namespace render

namespace app {
struct CheckJob;
struct Coverage;
class DebugSession;
struct PreparedCheck;
struct SetupSheet;
} // namespace app

namespace app::viewer {

struct SceneSetup;

/// The axis positions at one moment of a block.
struct Pose {
    double time = 0.0; // seconds after the block's start
    core::AxisValues values{};
};

/// The poses of a block in order of time, through all its motions; empty if nothing moves or the
/// position of an axis is unknown.
std::vector<Pose> poses_of(const core::Machine& machine, std::span<const core::Event> events);

/// The axis positions at a fraction of a block's time, 0..1.
std::optional<core::AxisValues> pose_at(const std::vector<Pose>& poses, double fraction);

/// A named value, and whether the block has changed it.
struct ShownValue {
    std::string name, text;
    bool changed = false;
};

/// The values after a block, marked if they differ from those before.
std::vector<ShownValue> compared(const std::vector<NamedValue>& before,
                                 const std::vector<NamedValue>& after);

/// The zero of the program's coordinates, as machine coordinates of the gauge line of a tool
/// without length.
struct ProgramZero {
    std::string name;                          // of the work offset: "G54"
    std::array<core::AxisValues, 4> positions; // of zero, and of 1 mm along X, Y and Z
    bool turns_with_work = false;              // else it stays in place while rotary axes move
};

/// A block and the state before or after it, for the window. Never changes.
struct BlockState {
    size_t block = 0;
    bool at_end = true; // true: the stock after the block; false: before it
    std::shared_ptr<const SceneSetup> scene;
    std::vector<Pose> poses;                  // of the block
    std::optional<core::AxisValues> standing; // axis positions after the block
    std::optional<core::ToolNumber> tool;     // used in the block
    std::optional<ProgramZero> zero;          // after the block
    // After the block; null: unknown. Its machine is that of the scene.
    std::shared_ptr<const gcode::Offsets> offsets_in_effect;
    std::vector<bool> mounted_fixtures;
    render::StockBricks stock;
    std::vector<ShownValue> modal, offsets, parameters;
    std::vector<ShownValue> watched;
    uint64_t serial = 0;      // consecutive number of the view
    bool is_outdated = false; // its stock is that of the set-up before
};

/// The facts about a program when it was opened.
struct OpenedProgram {
    std::string program, setup; // paths; setup is empty if inferred
    std::string dialect;
    std::vector<std::string> assumptions;
    bool is_inferred = false;
    bool is_inch = false;                     // the first unit of the program
    std::shared_ptr<const Coverage> coverage; // without holders and motion, which the rows show
    std::set<core::ToolNumber> tools_with_holder;
    bool counts_blocks = false; // its lines begin with block numbers without N
    std::shared_ptr<const SceneSetup> scene;
    std::shared_ptr<const SetupSheet> sheet; // the set-up with the sources of its values
    std::string proposed_path;               // default file for saving the set-up
    std::string setup_text;                  // with which it was opened; empty without a set-up
};

/// A program as it was read and its set-up completed.
OpenedProgram opened_program(const CheckJob& job, const PreparedCheck& check,
                             render::SurfaceMaker* surfaces = nullptr);

/// New or changed rows; they replace those from `first` on.
struct RowsUpdate {
    size_t first = 0;
    std::vector<BlockRow> rows;
    std::optional<size_t> count; // total number of rows, if it changed

    bool empty() const { return rows.empty() && !count; }
    /// Merges a later update into this one.
    void append(RowsUpdate later);
};

/// The direction of a walk.
enum class Walk : uint8_t { go_on, reverse_resume };

/// A request for the view of a block.
struct ShowRequest {
    size_t block = 0;
    bool at_end = true; // the state after the block; false: before it
};

/// Where a walk ended.
struct RunEnd {
    uint64_t walk = 0; // number of the walk
    size_t block = 0;  // the next block
    Stop stop;
};

/// What is new since the last update.
struct SessionUpdate {
    uint64_t opening = 0;  // number of the opened program
    uint64_t answered = 0; // the last request to open a program that succeeded or failed; 0: none
    std::shared_ptr<const OpenedProgram> opened;
    RowsUpdate rows;
    std::optional<std::vector<core::Finding>> findings;
    std::shared_ptr<const render::ToolPath> path;
    std::shared_ptr<const BlockState> block_state;
    std::optional<RunEnd> walk;
    std::optional<std::vector<Breakpoint>> breakpoints;
    std::optional<std::vector<std::string>> changes; // what-ifs that are in effect
    std::vector<std::string> files;     // that were read to open the program, or looked for
    std::optional<core::Error> failure; // the program could not be opened
    // It could not be opened again with another set-up: the session before it goes on.
    std::optional<core::Error> setup_error;
    bool is_again = false;              // the program is the one opened before, with another set-up
    std::string reading;                // a CAD file being read: "vise.step: meshing, 40 %"
    std::optional<std::string> refusal; // why a request was refused, as a sentence
    std::optional<core::Error> stopped; // the program could not be run to its end
    double fraction = 0.0;              // of the program, checked so far
    // Of the program so far; that of the whole program may be worse than that of its blocks.
    core::Verdict verdict = core::Verdict::clear;
    bool is_recorded = false;
    bool is_busy = false; // with opening or walking

    bool has_news = false;
};

/// Merges a later update into one that has not been read yet.
void merge(SessionUpdate& news, SessionUpdate later);

/// Publishes the new blocks of a growing record as updates. Keeps the whole path.
class SessionPublisher {
public:
    /// Starts with another program.
    void begin(std::vector<render::PathPoint> points, size_t rows);
    /// Restarts from a block after a change.
    void begin_again(size_t block, const std::vector<render::PathPoint>& points, size_t rows);

    /// Adds to `news` what is new in the record since the last call.
    void publish(const DebugSession& session, SessionUpdate& news);

private:
    using Clock = std::chrono::steady_clock;

    void add_rows(const DebugSession& session, SessionUpdate& news);
    /// The states of the checked blocks.
    std::vector<render::ClearanceState> clearance_states(const CheckRun& run) const;
    void paint_path(const DebugSession& session, SessionUpdate& news);
    /// The first row whose time changed since it was sent.
    size_t first_changed(const CheckRun& run) const;

    std::vector<render::PathPoint> points_;
    std::vector<double> durations_;              // as last sent
    std::vector<render::ClearanceState> states_; // of blocks, regardless of findings
    size_t rows_ = 0;                            // known to the window
    size_t findings_ = 0;
    bool is_whole_ = false;
    Clock::time_point last_path_ = {};
    Clock::duration path_cost_ = {};
};

} // namespace app::viewer
