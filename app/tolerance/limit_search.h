#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/ids.h"

namespace app {

/// The first pair that is not proven clear.
struct LimitingPair {
    size_t event = SIZE_MAX; // index in the recording; SIZE_MAX: no event
    std::optional<core::ToolNumber> tool;
    std::array<std::string, 2> pair; // names of the bodies; empty: not known
    std::optional<double> missing;   // mm by which the bound falls short; empty: not known
};

/// The largest deviation in one direction that was shown to be harmless.
struct ProvenLimit {
    double by = 0.0;                        // mm, at least 0
    std::optional<double> not_shown = {};   // the least larger one that could not be shown
    std::optional<LimitingPair> limit = {}; // what limits it; empty: the search ended at `most`
    size_t runs = 0;
};

/// Searches the largest deviation up to `most` for which `shown` finds no limit, to within 4 % or
/// 0.01 mm, in at most 12 runs. `shown` must only find limits beyond some deviation.
ProvenLimit proven_limit(double most,
                         const std::function<std::optional<LimitingPair>(double)>& shown);

} // namespace app
