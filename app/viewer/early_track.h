#pragma once

#include "app/viewer/program_track.h"
#include "app/viewer/session_update.h"

namespace app::viewer {

/// Blocks beyond these are only known once they are checked.
constexpr size_t most_early_blocks = 2'000'000;

/// A program before its stock is modelled: what can be shown at once.
struct EarlyTrack {
    ProgramTrack track;
    std::shared_ptr<const OpenedProgram> opened;
};

/// Runs a program to its end or its first error without checking it.
///
/// Errors: as DebugSession::open, but for the stock.
core::Result<EarlyTrack> early_track(const CheckJob& job, const std::function<bool()>& is_closing);

} // namespace app::viewer
