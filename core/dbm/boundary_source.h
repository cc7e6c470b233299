#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include "core/dbm/cut_model.h"

namespace core {

/// A boundary point of the model: an end of an interval of a line.
struct BoundaryPoint {
    int axis = 0, u = 0, v = 0; // the line
    double along = 0.0;
    bool upper = false; // the matter ends here, else it begins
};

/// What made the surface at a boundary point.
struct BoundarySource {
    Vec3 normal = Vec3(0.0);       // out of the matter, length 1
    std::optional<uint32_t> sweep; // the number in the model's log; empty: raw stock
};

/// Finds what made the surface of a model, point by point.
///
/// Refers to the model, which must not change. Remembers which sweeps came near the last places:
/// ask for points that lie together one after the other.
class BoundarySources {
public:
    explicit BoundarySources(const CutModel& model) : model_(model) {}

    BoundarySource at(const BoundaryPoint& point);

private:
    const std::vector<uint32_t>& near(const Vec3& place);
    std::optional<uint32_t> sweep_that_ends_at(const BoundaryPoint& point, const Vec3& place);

    const CutModel& model_;
    std::unordered_map<uint64_t, std::vector<uint32_t>> near_;
};

/// The direction out of the raw stock at a point of its surface; empty for a point that is farther
/// than 1e-6 mm from it.
std::optional<Vec3> raw_normal(const Solid& solid, const Vec3& place, int axis);

} // namespace core
