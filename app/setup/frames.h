#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/base/transform.h"
#include "core/sim/machine.h"

namespace app {

/// Where named frames stand in the machine: "machine", the work offsets, the bodies so far.
struct Frames {
    std::map<std::string, core::Transform> machine_from;

    std::optional<core::Transform> find(const std::string& name) const {
        const auto found = machine_from.find(name);
        if (found == machine_from.end()) return std::nullopt;
        return found->second;
    }
};

} // namespace app
