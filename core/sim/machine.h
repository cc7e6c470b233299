#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/sim/event.h"

namespace core {

/// One linear axis. `direction` is the way the tool moves relative to the work as the axis grows.
struct MachineAxis {
    Vec3 direction = Vec3(0.0); // unit length
    std::optional<double> min, max, home;
    std::optional<double> rapid;        // mm/min
    std::optional<double> acceleration; // mm/s2
};

/// straight: all axes arrive together; dogleg: each axis runs at its own speed.
enum class RapidStyle : uint8_t { straight, dogleg };

/// A mill with three linear axes.
struct Machine {
    std::array<MachineAxis, 3> axes = {{{{1, 0, 0}, {}, {}, {}, {}, {}},
                                        {{0, 1, 0}, {}, {}, {}, {}, {}},
                                        {{0, 0, 1}, {}, {}, {}, {}, {}}}};
    RapidStyle rapid = RapidStyle::straight;

    /// Where the gauge line stands in the machine frame at these axis values.
    Vec3 place(const Vec3& axis_values) const {
        Vec3 p(0.0);
        for (int i = 0; i < 3; ++i) p += axis_values[i] * axes[static_cast<size_t>(i)].direction;
        return p;
    }
    AxisPosition home() const { return {axes[0].home, axes[1].home, axes[2].home}; }
};

constexpr const char* axis_names[] = {"X", "Y", "Z"};

} // namespace core
