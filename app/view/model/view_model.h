#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/debug/what_if.h"
#include "app/view/model/file_browser.h"
#include "app/view/model/finding_group.h"
#include "app/view/model/row_filter.h"
#include "app/view/model/session_update.h"
#include "app/view/model/settings.h"
#include "app/view/model/timeline.h"
#include "app/view/model/workspace.h"
#include "render/scene.h"

namespace app {
struct CheckJob;
struct SetupSheet;
struct Tolerances;
} // namespace app

namespace app::viewer {

struct DeviceStudy;
struct DeviceUpdate;
class DeviceWorker;
struct ViewModel;

/// The state of the coprocessor in the window, and what the user has requested.
struct DeviceModel {
    std::string file;     // path of the device file; empty: the default device
    bool shown = false;   // its panel; while shown, the open program is run with it
    uint64_t opening = 0; // number of the program that is or was run; 0: none
    uint64_t run = 0;     // number of the run
    bool is_running = false;
    bool is_fitting = false; // all blocks are answered; trying other devices
    double fraction = 0.0;
    size_t blocks = 0; // answered so far
    std::shared_ptr<const DeviceStudy> study;
    std::optional<core::Error> failure;
};

/// The tolerances of the set-up in the window; see tolerance_sheet.h.
struct ToleranceModel {
    uint64_t opening = 0; // number of the program for which they were requested; 0: none
    uint64_t run = 0;     // number of the search
    bool is_running = false;
    double fraction = 0.0;
    std::shared_ptr<const Tolerances> found;
    std::optional<core::Error> failure;
};

/// Shows or hides the panel. When it is hidden, results stay on the timeline, but a run without
/// results is aborted.
void show_device(ViewModel& model, bool shown);

/// Whether the user has asked for the coprocessor: only then it has an icon.
bool has_device(const ViewModel& model);

/// Aborts the run and drops its results.
void switch_off_device(ViewModel& model);

/// Applies an update of the worker; ignores updates of earlier runs.
void take_in(ViewModel& model, DeviceUpdate news);

/// Starts and stops runs as the model requires. A run uses the open program, from its files and the
/// edits of the set-up. True if a run was started or stopped.
bool send_device_orders(ViewModel& model, DeviceWorker& worker,
                        const std::optional<CheckJob>& check);

/// Goes to the next or previous block that is late or not permitted, wrapping around at the ends.
/// False: none is known.
bool go_to_stop(ViewModel& model, bool forward);

/// The current block, and the fraction of its time, 0..1.
struct Cursor {
    size_t block = 0;
    double fraction = 1.0;

    bool operator==(const Cursor&) const = default;
};

constexpr double slowest = 0.1, fastest = 100.0;

/// Playback at a multiple of the speed of the machine.
struct Playback {
    bool running = false;
    double speed = 1.0;
    bool slow_near = false; // slower where the clearance is small
};

/// Axes that were moved by hand; they stay there until the cursor leaves `from`.
struct Jog {
    uint64_t opening = 0; // number of the program
    Cursor from;
    core::AxisValues values{}; // machine coordinates
};

/// The window that is open on top of the panels.
enum class Popup : uint8_t {
    none,
    shortcuts,
    go_to_line,
    open_file,
    what_if,
    breakpoint,
    settings,
    leaving,
    tolerances,
    report
};

/// Measuring between two clicked points.
struct Measuring {
    bool on = false;
    std::vector<core::Vec3> positions; // at most two, frame of the stock
};

/// The direction of a section: across an axis of the stock, or any other.
enum class SectionAxis : uint8_t { x, y, z, any };

/// What the next clicks in the view define.
enum class SectionPick : uint8_t { none, face, points };

/// A section of the view. Frame: the stock's.
struct Section {
    render::SectionPlane plane;
    SectionAxis axis = SectionAxis::y;
    core::Vec3 normal = core::Vec3(0.0, 1.0, 0.0); // of the axis or the picked plane, as positions
                                                   // count; the plane's own may be opposite
    core::Vec3 zero = core::Vec3(0.0);             // a point at position 0
    SectionPick pick = SectionPick::none;
    std::vector<core::Vec3> picked; // so far, of three points
    bool cuts_tool = false;

    bool is_flipped() const { return glm::dot(normal, plane.normal) < 0.0; }
};

/// A verdict in words, and how good it is: clear only with complete coverage.
struct VerdictWords {
    std::string text;
    render::ClearanceState state{};
};

/// The tab of an open program.
struct TabTitle {
    std::string name, path;
    render::ClearanceState state{}; // clear: checked to its end without a problem; none: not yet
    bool is_modified = false;       // its set-up has unsaved edits

    bool operator==(const TabTitle&) const = default;
};

/// Everything the window shows, and the input of the user, independent of a window. Functions that
/// change it are here and in navigation.h.
struct ViewModel {
    // the program and its check
    uint64_t opening = 0;
    std::shared_ptr<const OpenedProgram> program;
    std::vector<BlockRow> rows;
    MinimumTree least;
    std::vector<ToolBand> bands;
    std::vector<core::Finding> findings;
    std::vector<FindingGroup> groups; // of `findings`
    std::vector<size_t> offending;    // blocks, in program order
    std::string coverage;             // coverage_words of the program so far
    VerdictWords verdict;             // likewise
    std::shared_ptr<const render::ToolPath> path;
    std::shared_ptr<const BlockState> block_state;
    std::vector<std::string> changes;
    std::optional<core::Error> failure, stopped;
    std::string missing; // a file that was read, but has since been deleted or emptied
    double fraction = 0.0;
    core::Verdict program_verdict = core::Verdict::clear; // so far
    bool is_recorded = false, is_busy = false;
    uint64_t reading = 0;     // the request to open the program that has no answer yet; 0: none
    std::string reading_text; // the CAD file that is being read for it, and how far it is
    DeviceModel device;
    ToleranceModel tolerances;

    Workspace workspace; // the set-up
    Placing placing;

    // files to open
    FileBrowser browser;
    std::vector<RecentProgram> recent; // the last one first
    std::string unwanted_recent;       // program to be taken off that list; empty: none
    std::string samples;               // folder of the samples; empty: none

    // the open programs, in the window of the shown one
    std::string opened_path; // of this program, as it was asked for; empty: none
    std::vector<TabTitle> tabs;
    size_t shown_tab = 0;

    // input of the user
    Cursor cursor;
    BodyNames shown_pair; // of the finding that is shown; empty: the deciding pair of the block
    Playback playback;
    std::optional<Jog> jog;
    std::string filter_text;
    RowFilter filter;             // parsed
    std::vector<size_t> filtered; // rows that pass the filter; only with a filter
    std::vector<Breakpoint> breakpoints;
    std::set<size_t> bookmarks;
    std::vector<FindingNote> notes;            // of all programs
    std::optional<StretchIndex> selected = {}; // in the list of findings
    bool shows_findings = false;
    bool note_wants_focus = false; // until the field of the comment has the keyboard
    bool shows_setup = false;      // in place of lines and findings
    Settings settings;
    TimelineRange range;
    bool follows_timeline = true; // shows the whole program while it grows
    render::Camera camera;
    bool camera_placed = false;
    std::optional<size_t> hovered;    // block under the mouse in the last frame
    std::optional<size_t> pointed_at; // in this frame
    std::optional<BlockRow> resume;   // row to return to when the program is read again
    std::optional<Section> section;
    Measuring measuring;
    Popup popup = Popup::none;
    std::string message; // shown for some seconds
    double message_until = 0.0;
    bool awaits_offending = false;   // go to the next problem once one is found
    std::optional<uint64_t> walking; // number of the walk whose end is awaited
    bool wants_interrupt = false;    // of walks that are no longer awaited
    bool list_follows = true;        // the list scrolls to the cursor in the next frame
    bool filter_wants_focus = false; // until the field of the filter has the keyboard

    // requests to the worker
    std::optional<ShowRequest> wanted;
    std::optional<Walk> walk;
    std::optional<WhatIf> wanted_change; // from the cursor's block on
    bool wants_take_back = false;
    bool breakpoints_changed = false;
    std::vector<std::string> watches; // expressions
    bool watches_changed = false;
    std::vector<std::string> wanted_paths; // program, set-up or meshes to open

    // requests to the window
    bool notes_changed = false;
    bool wants_picture = false, wants_reload = false, wants_quit = false;
    std::optional<size_t> wanted_tab, unwanted_tab; // to be shown; to be closed
    bool wants_saving = false;                      // of the set-up, under its name
    std::string job_file;                           // of a CAM system or a control, to be read
    std::string report_title, report_text;          // about it
    std::optional<std::string> report_setup;        // the set-up that a button of it gives
    std::string report_question;                    // that button
    uint64_t report_version = 0;                    // of the set-up for which it is
    std::string sheet_path = {}; // the set-up sheet is to be saved under this name
    std::string save_path = {};  // the set-up is to be saved under this name

    bool has_rows() const { return !rows.empty(); }
    const BlockRow& row() const { return rows[cursor.block]; }
};

/// The set-up with the sources of its values, as it was read last; null if none was.
const SetupSheet* sheet_of(const ViewModel& model);

/// What the check of the program does not cover; empty if the set-up describes everything.
std::string coverage_words(const ViewModel& model);

/// The verdict on the program, as reports say it, with the number of errors; a bad one as soon as
/// it is known.
VerdictWords verdict_words(const ViewModel& model);

/// Whether the program is shown with the set-up as it is now. False after an edit until it has been
/// read, and while it cannot be read: then what is shown must not be taken for its result, nor
/// measured for another edit.
bool is_current(const ViewModel& model);

/// Cancels the current walk and the search for a violation.
void stay(ViewModel& model);

/// Applies an update of the worker. `now`: seconds, for the display of messages.
void take_in(ViewModel& model, SessionUpdate news, double now);

/// The message that there is no problem, and how much was checked.
std::string no_violation(const ViewModel& model);

/// Why the last good state is shown and not the files as they are; empty if it is not, or if the
/// panel of the set-up says so.
std::string last_good_words(const ViewModel& model);

/// Shows a message at the bottom of the view for some seconds.
void say(ViewModel& model, const std::string& text, double now);

/// Parses the filter again and applies it.
void apply_filter(ViewModel& model);

/// Findings about a block; without one, about the program as a whole.
std::vector<const core::Finding*> findings_of(const ViewModel& model, std::optional<size_t> block);

/// A length in the unit of the window, mm or inch, without the unit.
std::string length_text(const ViewModel& model, double mm, int decimals = 2);

/// As length_text, for a lower bound of a clearance: rounded down, never below 0.
std::string length_at_least(const ViewModel& model, double mm, int decimals = 2);

/// The lower bound of the clearance of a block that has one; ">= 50" without an upper bound.
std::string clearance_at_least(const ViewModel& model, const BlockRow& row);

/// The clearance of a block as lists show it: "1.90"; "-3.20" for an overlap that is at
/// most so deep; "cutting" or "contact" for bodies that touch as intended.
std::string clearance_words(const ViewModel& model, const BlockRow& row);

/// How deep an overlap is, as reports say it, in the unit of the window, without the unit:
/// "1.96 to 2.01".
std::string depth_words(const ViewModel& model, const core::Overlap& overlap);

/// As length_text, for an upper bound or an allowance: rounded up.
std::string length_at_most(const ViewModel& model, double mm, int decimals = 2);
const char* length_unit(const ViewModel& model);

/// The title of the window. It includes the current block, for window lists and screen readers, and
/// the answer of the device if the coprocessor panel is open.
std::string window_title(const ViewModel& model);

} // namespace app::viewer
