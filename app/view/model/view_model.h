#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/view/model/finding_group.h"
#include "app/view/model/row_filter.h"
#include "app/view/model/session_update.h"
#include "app/view/model/settings.h"
#include "app/view/model/timeline.h"
#include "render/scene.h"

namespace app {
struct CheckJob;
struct SetupEdits;
} // namespace app

namespace app::viewer {

struct DeviceStudy;
struct DeviceUpdate;
class DeviceWorker;
struct ViewModel;

/// What the window knows of the coprocessor, and what a person wants of it.
struct DeviceModel {
    std::string file;     // of the device; empty: the usual one
    bool shown = false;   // its panel; while it is open, the program that is open is run
    uint64_t opening = 0; // of the program that was run, or is; 0: none
    uint64_t run = 0;     // its number
    bool is_running = false;
    bool is_fitting = false; // the answers are there, other devices are tried
    double share = 0.0;
    size_t blocks = 0; // that were asked so far
    std::shared_ptr<const DeviceStudy> study;
    std::optional<core::Error> failure;
};

/// Shows the panel, or hides it. What it has shown stays on the timeline; a run that has not
/// answered yet ends.
void show_device(ViewModel& model, bool shown);

/// Ends the run and forgets what came of it.
void switch_off_device(ViewModel& model);

/// Takes in what the worker has to tell; nothing of runs that nobody waits for any more.
void take_in(ViewModel& model, DeviceUpdate news);

/// Begins and ends runs, as the model says: what is run is the program that is open, as its files
/// and the edits of the set-up have it. Whether anything was begun or ended.
bool send_device_orders(ViewModel& model, DeviceWorker& worker,
                        const std::optional<CheckJob>& check);

/// To the next or previous block that the machine has to wait for or may not run, past the end to
/// the other one. Whether there is one that is known.
bool go_to_stop(ViewModel& model, bool forward);

/// The block that everything follows, and how far it is through, 0..1 of its time.
struct Cursor {
    size_t block = 0;
    double share = 1.0;

    bool operator==(const Cursor&) const = default;
};

constexpr double slowest = 0.1, fastest = 100.0;

/// Playing at the speed of the machine, times so much.
struct Playback {
    bool running = false;
    double speed = 1.0;
    bool slow_near = false; // slower where the clearance is small
};

/// What lies on top of everything else.
enum class Popup : uint8_t {
    none,
    shortcuts,
    go_to_line,
    open_file,
    what_if,
    breakpoint,
    settings,
    setup
};

/// What the window is to do with the set-up.
struct SetupRequest {
    std::shared_ptr<const SetupEdits> edits;
    std::string save_path = {}; // empty: only check with the edits
    bool may_replace = false;
};

/// Two places clicked, and the way between them.
struct Measuring {
    bool on = false;
    std::vector<core::Vec3> places; // frame of the stock; at most two
};

/// Everything the window shows and everything a person has said, without a window. The functions
/// that change it are in navigation.h and news.h.
struct ViewModel {
    // what is known of the program
    uint64_t opening = 0;
    std::shared_ptr<const OpenedProgram> program;
    std::vector<BlockRow> rows;
    MinimumTree least;
    std::vector<ToolBand> bands;
    std::vector<core::Finding> findings;
    std::vector<FindingGroup> groups; // of them
    std::vector<size_t> offending;    // blocks, in order
    size_t near_count = 0;
    std::shared_ptr<const render::ToolPath> path;
    std::shared_ptr<const PlaceView> place;
    std::vector<std::string> changes;
    std::shared_ptr<const SetupEdits> edits; // of the set-up, when opened; null: none
    std::optional<SetupSaved> saved;         // the last answer to a wish to save the set-up
    std::optional<core::Error> failure, stopped;
    std::string missing; // a file that is shown, but is gone or empty by now
    double share = 0.0;
    bool is_recorded = false, is_busy = false;
    DeviceModel device; // beside which it is run

    // what a person has said
    Cursor cursor;
    Playback playback;
    std::string filter_text;
    RowFilter filter;             // as it was read
    std::vector<size_t> filtered; // rows that the filter lets through; only with a filter
    std::vector<Breakpoint> breakpoints;
    std::set<size_t> bookmarks;
    std::vector<FindingNote> notes;            // of all programs
    std::optional<StretchPlace> selected = {}; // in the list of findings
    bool shows_findings = false, note_wants_focus = false;
    Settings settings;
    TimelineRange range;
    bool follows_timeline = true; // the whole program, as it grows
    render::Camera camera;
    bool camera_placed = false;
    std::optional<size_t> hovered;    // block that was pointed at when the last frame was drawn
    std::optional<size_t> pointed_at; // in this one
    std::optional<BlockRow> resume;   // where to go on when the program has been read again
    bool opens_another = false;       // the next opening is of another program
    std::optional<render::SectionPlane> section;
    Measuring measuring;
    Popup popup = Popup::none;
    std::string message; // shown for a while
    double message_until = 0.0;
    bool awaits_offending = false;   // goes to the next violation as soon as one is found
    std::optional<uint64_t> walking; // number of the walk whose end the worker shall tell
    bool wants_interrupt = false;    // of walks whose end nobody waits for any more
    bool list_follows = true;        // the list scrolls to the cursor once
    bool filter_wants_focus = false;

    // what the worker is to be asked
    std::optional<ShowRequest> wanted;
    std::optional<Walk> walk;
    std::optional<WhatIf> wanted_change; // from the cursor's block on
    bool wants_take_back = false;
    bool breakpoints_changed = false;
    std::vector<std::string> watches; // expressions
    bool watches_changed = false;
    std::optional<SetupRequest> wanted_setup;
    bool wants_saving = false; // the popup is to ask for a file
    std::string wanted_path;   // of a program, set-up or mesh that was dropped or typed

    // what the window is to do
    bool notes_changed = false;
    bool wants_picture = false, wants_reload = false, wants_quit = false;

    bool has_rows() const { return !rows.empty(); }
    const BlockRow& row() const { return rows[cursor.block]; }
};

/// Goes on to nothing that was asked for before: no walk, no violation that is still to be found.
void stay(ViewModel& model);

/// Takes in what the worker has to tell. `now`: seconds, as messages are timed.
void take_in(ViewModel& model, SessionUpdate news, double now);

/// That there is no violation, as far as that is known.
std::string no_violation(const ViewModel& model);

/// Says something at the foot of the view for some seconds.
void say(ViewModel& model, const std::string& text, double now);

/// Filters anew.
void apply_filter(ViewModel& model);

/// Findings about a block, or about the program as a whole.
std::vector<const core::Finding*> findings_of(const ViewModel& model, std::optional<size_t> block);

/// A length as it is shown: mm or inch, without its unit.
std::string length_text(const ViewModel& model, double mm, int decimals = 2);

/// A lower bound of a clearance in the same way: never more than it is, and never below 0.
std::string length_at_least(const ViewModel& model, double mm, int decimals = 2);

/// An upper bound, or what must be kept: never less than it is.
std::string length_at_most(const ViewModel& model, double mm, int decimals = 2);
const char* length_unit(const ViewModel& model);

} // namespace app::viewer
