#pragma once

#include <array>
#include <span>
#include <vector>

#include "hwsim/memory_line.h"

namespace bench {

/// A sphere, in steps of the device.
struct Sphere {
    hwsim::FixedVec centre{};
    int32_t radius = 0; // 24 bits: at most half the diagonal of everything
};

/// For each memory line that is a node: the bounding spheres of its two children.
using SphereTable = std::vector<std::array<Sphere, 2>>;

/// The paper's bounding sphere of some records: its centre is that of their box, rounded to a step;
/// its radius is the greatest distance from there to a point of a record, rounded up.
Sphere sphere_round(std::span<const hwsim::Record> records, hwsim::Side side);

/// Adds the spheres of the model below a header. The tree is unchanged, so that spheres and boxes
/// are tested at the same nodes. The memory must be intact.
void add_spheres(SphereTable& table, std::span<const hwsim::Line> memory, uint32_t header,
                 hwsim::Side side);

} // namespace bench
