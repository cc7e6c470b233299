#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/motion/timing.h"

namespace test_support {

/// The speed limits of a motion: along it, and at the corner before it.
struct SpeedPiece {
    double length, acceleration, cruise, corner;
};

/// The times of the pieces in seconds if the whole is run as fast as possible from rest to rest:
/// squared speeds at `steps` points of each piece, lowered until none changes faster than allowed.
inline std::vector<double> fastest_times(const std::vector<SpeedPiece>& pieces, int steps) {
    std::vector<double> squared{0.0}, step, acceleration;
    for (size_t i = 0; i < pieces.size(); ++i) {
        const double cruise = pieces[i].cruise * pieces[i].cruise;
        const double corner = i == 0 ? 0.0 : pieces[i].corner * pieces[i].corner;
        squared.back() = std::min({squared.back(), corner, cruise});
        for (int k = 0; k < steps; ++k) {
            squared.push_back(cruise);
            step.push_back(pieces[i].length / steps);
            acceleration.push_back(pieces[i].acceleration);
        }
    }
    squared.back() = 0.0;
    for (size_t i = 0; i < step.size(); ++i)
        squared[i + 1] = std::min(squared[i + 1], squared[i] + 2.0 * acceleration[i] * step[i]);
    for (size_t i = step.size(); i-- > 0;)
        squared[i] = std::min(squared[i], squared[i + 1] + 2.0 * acceleration[i] * step[i]);
    std::vector<double> times(pieces.size(), 0.0);
    for (size_t i = 0; i < step.size(); ++i)
        times[i / static_cast<size_t>(steps)] +=
            2.0 * step[i] / (std::sqrt(squared[i]) + std::sqrt(squared[i + 1]));
    return times;
}

/// The motion of a machine through a rounded corner that takes `lasts` seconds: the rates change
/// linearly from those before to those after, at this speed along both.
struct CornerRun {
    core::AxisValues acceleration{}; // maximum of each axis
    double missed = infinity;        // least distance from the corner along X, Y, Z
    double length = 0.0;             // of either motion that the corner takes up

    static constexpr double infinity = core::infinity;
};

inline CornerRun run_corner(const core::AxisValues& before, const core::AxisValues& after,
                            double speed, double lasts) {
    CornerRun run;
    run.length = 0.5 * speed * lasts;
    constexpr int steps = 2000;
    core::AxisValues position{}, rate{};
    for (size_t i = 0; i < position.size(); ++i) position[i] = -run.length * before[i];
    const double tick = lasts / steps;
    for (int k = 0; k <= steps; ++k) {
        run.missed = std::min(run.missed, std::hypot(position[0], position[1], position[2]));
        for (size_t i = 0; i < position.size(); ++i) {
            const double fraction = (k + 0.5) / steps;
            const double now = speed * (before[i] + fraction * (after[i] - before[i]));
            if (k > 0)
                run.acceleration[i] = std::max(run.acceleration[i], std::abs(now - rate[i]) / tick);
            rate[i] = now;
            position[i] += now * tick;
        }
    }
    return run;
}

} // namespace test_support
