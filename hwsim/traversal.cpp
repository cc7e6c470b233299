#include "hwsim/traversal.h"

#include <cstdlib>

#include "hwsim/pair_distance.h"

namespace hwsim {
namespace {

int64_t longest_side(const Box& box) {
    int64_t longest = 0;
    for (size_t axis = 0; axis < 3; ++axis)
        longest = std::max(longest, int64_t{box.max[axis]} - box.min[axis]);
    return longest;
}

int64_t longest_side(const Volume& volume) {
    const Box& box = volume.box;
    const int64_t x = int64_t{box.max[0]} - box.min[0], y = int64_t{box.max[1]} - box.min[1];
    return std::max({x + 2 * int64_t{volume.radius}, y + 2 * int64_t{volume.radius},
                     int64_t{box.max[2]} - box.min[2]});
}

int64_t longest_way(const FixedVec& from, const FixedVec& to) {
    int64_t longest = 0;
    for (size_t axis = 0; axis < 3; ++axis)
        longest = std::max(longest, std::abs(int64_t{to[axis]} - from[axis]));
    return longest;
}

} // namespace

SearchPair first_pair(const Query& query) {
    return {.tool = Reference::node(query.tool_header),
            .work = Reference::node(query.work_header),
            .tool_volume = {everywhere, 0},
            .work_box = everywhere,
            .first = 0,
            .last = static_cast<uint16_t>(1U << query.segment.log2_steps)};
}

Division division_of(const SearchPair& pair, const Segment& segment) {
    const int64_t work = pair.work.is_leaf() ? -1 : longest_side(pair.work_box);
    const int64_t tool = pair.tool.is_leaf() ? -1 : longest_side(pair.tool_volume);
    const int64_t way = longest_way(offset_at(segment, pair.first), offset_at(segment, pair.last));
    if (tool >= 0 && tool >= work && tool >= way) return Division::tool;
    if (work >= 0 && work >= way) return Division::work;
    return way > 0 ? Division::way : Division::none;
}

std::optional<uint64_t> squared_gap(const Volume& tool, const FixedVec& from, const FixedVec& to,
                                    const Box& work) {
    std::array<int64_t, 3> gap{};
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t min = int64_t{tool.box.min[axis]} + std::min(from[axis], to[axis]);
        const int64_t max = int64_t{tool.box.max[axis]} + std::max(from[axis], to[axis]);
        const int64_t aside = axis == 2 ? 0 : tool.radius;
        if (!is_coordinate(min - aside) || !is_coordinate(max + aside)) return {};
        gap[axis] = std::max({work.min[axis] - max, min - work.max[axis], int64_t{0}});
    }
    return squared_distance(gap, tool.radius);
}

std::optional<uint64_t> squared_gap(const SearchPair& pair, const Segment& segment) {
    return squared_gap(pair.tool_volume, offset_at(segment, pair.first),
                       offset_at(segment, pair.last), pair.work_box);
}

Halves halves_of_node(const SearchPair& pair, Division division, const Node& node) {
    Halves halves;
    for (size_t i = 0; i < 2; ++i) {
        SearchPair& half = halves.pair[i];
        half = pair;
        (division == Division::work ? half.work : half.tool) = node.child[i];
        if (division == Division::work)
            half.work_box = node.volume[i].box;
        else
            half.tool_volume = node.volume[i];
        halves.there[i] = !node.child[i].is_none();
    }
    return halves;
}

Halves halves_of_way(const SearchPair& pair) {
    const auto middle = static_cast<uint16_t>((pair.first + pair.last) / 2);
    Halves halves{.pair = {pair, pair}, .there = {true, true}};
    halves.pair[0].last = middle;
    halves.pair[1].first = static_cast<uint16_t>(middle + 1);
    return halves;
}

} // namespace hwsim
