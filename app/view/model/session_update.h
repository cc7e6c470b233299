#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/debug/debug_session.h"
#include "app/view/model/block_row.h"
#include "core/motion/event.h"
#include "render/stock_brick.h"
#include "render/tool_path.h"

namespace core {
struct Machine;
} // namespace core

namespace app {
struct SetupSheet;
} // namespace app

namespace app::viewer {

struct SceneSetup;

/// Where the axes are at a moment of a block.
struct Pose {
    double time = 0.0; // seconds after the block's start
    core::AxisValues values{};
};

/// The poses of a block in order of time, every motion from end to end; empty when nothing moves or
/// an axis may stand anywhere.
std::vector<Pose> poses_of(const core::Machine& machine, std::span<const core::Event> events);

/// Where the axes are at a share of a block's time, 0..1.
std::optional<core::AxisValues> pose_at(const std::vector<Pose>& poses, double share);

/// A value with a name, and whether the block has changed it.
struct ShownValue {
    std::string name, text;
    bool changed = false;
};

/// Values after a block, marked where they differ from those before.
std::vector<ShownValue> compared(const std::vector<NamedValue>& before,
                                 const std::vector<NamedValue>& after);

/// A block and the state round it, for the window. It never changes once it is made.
struct PlaceView {
    size_t block = 0;
    bool at_end = true; // the stock is as the block leaves it; false: as it found it
    std::shared_ptr<const SceneSetup> scene;
    std::vector<Pose> poses;                  // of the block
    std::optional<core::AxisValues> standing; // where the axes are after it
    std::optional<core::ToolNumber> tool;     // that moves in it
    std::vector<bool> fixtures_there;
    render::StockBricks stock;
    std::vector<ShownValue> modal, axes, offsets, parameters;
    std::vector<ShownValue> watched;
    uint64_t serial = 0; // counts views
};

/// What a program was opened with, as the window spells it out.
struct OpenedProgram {
    std::string program, setup; // paths; setup is empty when it was inferred
    std::string dialect;
    std::vector<std::string> assumptions;
    bool is_inferred = false;
    bool counts_blocks = false; // its lines begin with the numbers of their blocks, without N
    std::shared_ptr<const SceneSetup> scene;
    std::shared_ptr<const SetupSheet> sheet; // what of the set-up can be edited
    std::string proposed_path;               // where the set-up is saved if nobody says otherwise
};

/// Rows that are new or have changed: they replace those from `first` on.
struct RowsUpdate {
    size_t first = 0;
    std::vector<BlockRow> rows;
    std::optional<size_t> count; // of all rows, where that is settled anew

    bool empty() const { return rows.empty() && !count; }
    /// Takes in a later update.
    void append(RowsUpdate later);
};

/// How far a walk goes.
enum class Walk : uint8_t { go_on, go_on_back };

/// A block that the window wants to see the state round.
struct ShowRequest {
    size_t block = 0;
    bool at_end = true; // else as the block finds it
};

/// Writes a set-up file, whole or not at all; the same as app::FileWriter.
using SetupWriter =
    std::function<core::Result<void>(const std::string& path, const std::string& text)>;

/// A set-up that was to be saved.
struct SetupSaved {
    std::string path;
    std::optional<core::Error> refusal;
    bool exists = false; // it was refused because the file is there
};

/// Where a walk ended.
struct WalkEnd {
    uint64_t walk = 0; // its number
    size_t block = 0;  // the block before which it stands
    Stop stop;
};

/// Everything that has become known since the last look.
struct SessionUpdate {
    uint64_t opening = 0; // counts programs opened
    std::shared_ptr<const OpenedProgram> opened;
    RowsUpdate rows;
    std::optional<std::vector<core::Finding>> findings;
    std::shared_ptr<const render::ToolPath> path;
    std::shared_ptr<const PlaceView> place;
    std::optional<WalkEnd> walk;
    std::optional<std::vector<Breakpoint>> breakpoints;
    std::optional<std::vector<std::string>> changes; // what-ifs that are in effect
    std::optional<core::Error> failure;              // the program could not be opened
    std::optional<std::string> refusal;              // of a request, in a sentence
    std::optional<SetupSaved> saved;
    std::optional<core::Error> stopped; // the program could not be run to its end
    double share = 0.0;                 // of the program that is checked
    bool is_recorded = false;
    bool is_busy = false; // with opening or walking

    bool has_news = false;
};

/// Takes a later update into one that nobody has looked at yet.
void merge(SessionUpdate& news, SessionUpdate later);

/// Turns what a record gains into updates, and keeps what the whole path looks like.
class SessionPublisher {
public:
    /// Another program: all of it is new.
    void begin(std::vector<render::PathPoint> points, size_t rows);
    /// From a block on the program goes another way.
    void begin_again(size_t block, const std::vector<render::PathPoint>& points, size_t rows);

    /// What the record has gained since the last call.
    void publish(const DebugSession& session, SessionUpdate& news);

private:
    using Clock = std::chrono::steady_clock;

    void add_rows(const DebugSession& session, SessionUpdate& news);
    /// The states of the blocks that were checked.
    std::vector<render::ClearanceState> known_states(const CheckRun& run) const;
    void paint_path(const DebugSession& session, SessionUpdate& news);
    /// The first row whose time has been settled since it was sent.
    size_t first_changed(const CheckRun& run) const;

    std::vector<render::PathPoint> points_;
    std::vector<double> durations_;              // as they were sent
    std::vector<render::ClearanceState> states_; // of blocks, but for the findings about them
    size_t rows_ = 0;                            // known to the window
    size_t findings_ = 0;
    bool is_whole_ = false;
    Clock::time_point last_path_ = {};
    Clock::duration path_cost_ = {};
};

} // namespace app::viewer
