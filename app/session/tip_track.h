#pragma once

#include <optional>
#include <vector>

#include "core/sim/event.h"

namespace app {

/// The way of a tool's tip over one motion, machine frame; arcs by places on them.
struct TipTrack {
    std::vector<core::Vec3> places;
    bool sideways = false; // it moves in X or Y

    double lowest() const;
    double length() const;
};

/// The way of the tip of a tool of a length; empty where an end is not known.
std::optional<TipTrack> tip_track(const core::Motion& motion, double tool_length);

} // namespace app
