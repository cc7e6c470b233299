#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/tolerance/deviation.h"
#include "core/base/result.h"

namespace app {

struct CheckJob;
struct CheckRun;

/// How far a quantity may deviate in one direction.
struct ToleranceLimit {
    double by = 0.0;                 // mm; the check is proven to stay clear up to here
    bool is_open = false;            // it may be more: the search ended here
    std::optional<double> not_shown; // mm; the next larger deviation that could not be shown
    uint32_t line = 0;               // of the block that limits it; 0: none, or not known
    std::string file;                // of its subprogram
    std::optional<core::ToolNumber> tool;
    std::array<std::string, 2> pair; // the bodies; or an axis and "limit"; empty: not known
};

/// A quantity with its tolerance.
struct Tolerance {
    Deviation deviation;
    ToleranceLimit less, more; // towards smaller and larger values
    std::string unknown;       // why nothing is known; empty if the limits are
    std::string not_studied;   // why it was not studied; empty if it was

    bool is_known() const { return unknown.empty() && not_studied.empty(); }
};

/// The tolerances of a set-up.
struct Tolerances {
    std::string refusal; // why there are none
    std::vector<Tolerance> list;
    size_t runs = 0; // simulations
    size_t work = 0; // of them, in tests: see most_tolerance_work
    double seconds = 0.0;
};

/// The largest deviation that is looked for, mm; of a diameter.
constexpr double widest_deviation = 20.0, widest_diameter_change = 0.5;

/// The most work of all simulations together, in tests: pairs of boxes and of shapes compared, with
/// 20 for each recomputed square and 100 for each motion and each cut. Some ten to twenty minutes
/// of one processor.
constexpr size_t most_tolerance_work = 500'000'000;

/// The largest deviation of each quantity of the set-up, one at a time, for which the check is
/// proven to stay clear. `run` is the result of the check. Quantities without an effect on the
/// program are left out. `goes_on` is called from time to time, from several threads, with the part
/// that is done, 0 to 1; false: stop. The list then lacks what was not finished. If the control may
/// read the program in several ways, the tolerances hold for all of them. The quantities are
/// studied in the order of the list until their simulations have done `most_work`; the one that
/// exceeds it and all later ones are not studied. Which these are depends on the job alone.
///
/// Errors: those of reading the program and the set-up again.
/// Cost:   some five simulations for each direction, on all processors.
core::Result<Tolerances> tolerances_of(const CheckJob& job, const CheckRun& run,
                                       const std::function<bool(double)>& goes_on = {},
                                       size_t most_work = most_tolerance_work);

/// The title of a tolerance: "G54 X", "tool 3, stick-out".
std::string title_of(const Deviation& deviation);

/// "-3.1 to +12.4 mm"; "-0.4 to +20 mm or more"; or why it is not known. In mm or inch.
std::string range_text(const Tolerance& tolerance, bool inch = false);

/// What limits it, such as "line 210: holder of tool 3 near clamp left"; empty if nothing does.
std::string limit_text(const ToleranceLimit& limit);

} // namespace app
