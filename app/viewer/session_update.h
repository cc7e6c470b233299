#pragma once

#include "app/session/debug_session.h"
#include "app/session/setup_sheet.h"
#include "app/viewer/block_row.h"
#include "app/viewer/place_view.h"
#include "render/tool_path.h"

namespace app::viewer {

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

} // namespace app::viewer
