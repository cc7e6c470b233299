#pragma once

#include <array>
#include <span>
#include <vector>

#include "hwsim/memory_line.h"

namespace bench {

/// A ball, in steps of the device.
struct Sphere {
    hwsim::FixedVec centre{};
    int32_t radius = 0; // 24 bits: half the diagonal of everything at most
};

/// For each line of a memory that is a node: spheres round what its two children hold.
using SphereTable = std::vector<std::array<Sphere, 2>>;

/// The paper's sphere round some records: its centre is that of their box, rounded to a step, its
/// radius the greatest distance from there to a point of a record, rounded up.
Sphere sphere_round(std::span<const hwsim::Record> records, hwsim::Side side);

/// Adds the spheres of the model below a header. The tree stays as it is, so that spheres and boxes
/// are asked of the same nodes. The memory must be intact.
void add_spheres(SphereTable& table, std::span<const hwsim::Line> memory, uint32_t header,
                 hwsim::Side side);

} // namespace bench
