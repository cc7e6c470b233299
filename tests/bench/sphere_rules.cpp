#include "tests/bench/sphere_rules.h"

#include <limits>

#include "hwsim/memory_line.h"

namespace bench {
namespace {

using hwsim::Division;
using hwsim::Reference;

/// The greatest integer whose square is at most this.
int64_t root_down(int64_t square) {
    const int64_t root = hwsim::root_up(square);
    return root * root == square ? root : root - 1;
}

/// Whether a tool stays in the range of coordinates: tests its root's box over the whole path, as
/// the device does first.
bool is_in_range(const hwsim::Node& header, const hwsim::Segment& segment) {
    return header.child[0].is_none()
           || hwsim::squared_gap(header.volume[0], segment.start, segment.end, hwsim::everywhere);
}

} // namespace

SphereRules::SphereRules(std::span<const hwsim::Line> memory, const SphereTable& table,
                         const hwsim::Query& query)
    : table_(table), query_(query) {
    const hwsim::Segment& segment = query.segment;
    int64_t square = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t along = int64_t{segment.end[axis]} - segment.start[axis];
        square += along * along;
    }
    way_ = hwsim::root_up(square);
    in_range_ = is_in_range(hwsim::node_in(memory[query.tool_header]), segment);
}

SpherePair SphereRules::first_pair() const {
    const Sphere everything{{}, std::numeric_limits<int32_t>::max()};
    return {.tool = Reference::node(query_.tool_header),
            .work = Reference::node(query_.work_header),
            .tool_sphere = everything,
            .work_sphere = everything,
            .first = 0,
            .last = static_cast<uint16_t>(1U << query_.segment.log2_steps)};
}

Division SphereRules::division_of(const SpherePair& pair) const {
    const int64_t tool = pair.tool.is_leaf() ? -1 : pair.tool_sphere.radius;
    const int64_t work = pair.work.is_leaf() ? -1 : pair.work_sphere.radius;
    const int64_t way = stretch(pair.first, pair.last).radius;
    if (tool >= 0 && tool >= work && tool >= way) return Division::tool;
    if (work >= 0 && work >= way) return Division::work;
    return way > 0 ? Division::way : Division::none;
}

SphereRules::SplitPairs SphereRules::halves_of_node(const SpherePair& pair, Division division,
                                                    uint32_t line, const hwsim::Node& node) const {
    SplitPairs halves;
    for (size_t i = 0; i < 2; ++i) {
        if (node.child[i].is_none()) continue;
        SpherePair half = pair;
        const bool of_work = division == Division::work;
        (of_work ? half.work : half.tool) = node.child[i];
        (of_work ? half.work_sphere : half.tool_sphere) = table_[line][i];
        halves[i] = half;
    }
    return halves;
}

SphereRules::SplitPairs SphereRules::split_at_middle(const SpherePair& pair) {
    const auto middle = static_cast<uint16_t>((pair.first + pair.last) / 2);
    SplitPairs halves{pair, pair};
    halves[0]->last = middle;
    halves[1]->first = static_cast<uint16_t>(middle + 1);
    return halves;
}

bool SphereRules::test(SpherePair& pair) const {
    if (!in_range_) return false;
    const Sphere at = stretch(pair.first, pair.last);
    int64_t square = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t apart = int64_t{pair.tool_sphere.centre[axis]} + at.centre[axis]
                              - pair.work_sphere.centre[axis];
        square += apart * apart;
    }
    pair.apart = static_cast<uint64_t>(square);
    const int64_t radii = int64_t{pair.tool_sphere.radius} + pair.work_sphere.radius + at.radius;
    pair.bound = static_cast<uint64_t>(std::max(root_down(square) - radii, int64_t{0}));
    return true;
}

Sphere SphereRules::stretch(uint32_t first, uint32_t last) const {
    const hwsim::Segment& segment = query_.segment;
    Sphere at;
    const int halvings = segment.log2_steps + 1;
    const int64_t one = int64_t{1} << halvings;
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t way = int64_t{segment.end[axis]} - segment.start[axis];
        const int64_t part = (int64_t{first + last} * way + one / 2) >> halvings;
        at.centre[axis] = static_cast<int32_t>(segment.start[axis] + part);
    }
    if (first == last || way_ == 0) return at;
    // Middle and samples are off by half a step along each axis, together by at most root(3).
    constexpr int64_t rounding = 2;
    const int64_t half = (int64_t{last - first} * way_ + one - 1) >> halvings;
    at.radius = static_cast<int32_t>(half + rounding);
    return at;
}

} // namespace bench
