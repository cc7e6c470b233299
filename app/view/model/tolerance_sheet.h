#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace app {
struct CheckJob;
} // namespace app

namespace app::viewer {

class ToleranceWorker;
struct ToleranceUpdate;
struct ViewModel;

/// What limits a tolerance in one direction.
struct ToleranceCause {
    std::string words;                // empty: nothing does
    std::optional<size_t> block = {}; // to which a click goes
};

/// A value of the set-up and how far it may deviate.
struct ToleranceLine {
    std::string name, range;
    bool is_known = true;
    std::array<ToleranceCause, 2> causes; // downwards, upwards
};

/// All texts about the tolerances of the set-up.
struct ToleranceSheet {
    std::string status; // progress, error, or why there are none; empty: see the lines
    bool has_failed = false;
    std::vector<ToleranceLine> lines;
};

/// The texts of the dialog.
ToleranceSheet tolerance_sheet(const ViewModel& model);

/// Applies an update of the worker; ignores updates of earlier searches.
void take_in(ViewModel& model, ToleranceUpdate news);

/// Starts a search when the dialog is first opened for a program, and stops it when another one is
/// opened. A search uses the open program, from its files and the edits of the set-up. True if one
/// was started or stopped.
bool send_tolerance_orders(ViewModel& model, ToleranceWorker& worker,
                           const std::optional<CheckJob>& check);

} // namespace app::viewer
