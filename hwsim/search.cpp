#include "hwsim/search.h"

#include <cstdlib>
#include <vector>

#include "hwsim/memory_line.h"

namespace hwsim {
namespace {

int64_t longest_side(const Box& box) {
    int64_t longest = 0;
    for (size_t axis = 0; axis < 3; ++axis)
        longest = std::max(longest, int64_t{box.max[axis]} - box.min[axis]);
    return longest;
}

int64_t size_of(const Volume& volume, Volumes volumes) {
    if (volumes == Volumes::spheres)
        return longest_side(volume.box) + 2 * int64_t{volume.radius}; // the box of a header is wide
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

Division division_of(const SearchPair& pair, const Segment& segment, Volumes volumes) {
    const Volume work_volume{pair.work_box, pair.work_radius};
    const int64_t work = pair.work.is_leaf() ? -1 : size_of(work_volume, volumes);
    const int64_t tool = pair.tool.is_leaf() ? -1 : size_of(pair.tool_volume, volumes);
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

std::optional<uint64_t> squared_gap_of_spheres(const Volume& tool, const FixedVec& from,
                                               const FixedVec& to, const Volume& work) {
    int64_t square = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t min = int64_t{tool.box.min[axis]} + std::min(from[axis], to[axis]);
        const int64_t max = int64_t{tool.box.max[axis]} + std::max(from[axis], to[axis]);
        if (!is_coordinate(min - tool.radius) || !is_coordinate(max + tool.radius)) return {};
        const int64_t gap =
            std::max({work.box.min[axis] - max, min - work.box.max[axis], int64_t{0}});
        square += gap * gap;
    }
    const int64_t root = root_up(square);
    const int64_t rounded_down = root * root == square ? root : root - 1;
    const int64_t apart = std::max(rounded_down - tool.radius - int64_t{work.radius}, int64_t{0});
    return static_cast<uint64_t>(apart * apart);
}

std::optional<uint64_t> squared_gap(const SearchPair& pair, const FixedVec& from,
                                    const FixedVec& to, Volumes volumes) {
    if (volumes == Volumes::boxes) return squared_gap(pair.tool_volume, from, to, pair.work_box);
    return squared_gap_of_spheres(pair.tool_volume, from, to, {pair.work_box, pair.work_radius});
}

SplitPairs halves_of_node(const SearchPair& pair, Division division, const Node& node) {
    SplitPairs halves;
    for (size_t i = 0; i < 2; ++i) {
        SearchPair& half = halves.pair[i];
        half = pair;
        (division == Division::work ? half.work : half.tool) = node.child[i];
        if (division == Division::work) {
            half.work_box = node.volume[i].box;
            half.work_radius = node.volume[i].radius;
        } else {
            half.tool_volume = node.volume[i];
        }
        halves.there[i] = !node.child[i].is_none();
    }
    return halves;
}

SplitPairs split_at_middle(const SearchPair& pair) {
    const auto middle = static_cast<uint16_t>((pair.first + pair.last) / 2);
    SplitPairs halves{.pair = {pair, pair}, .there = {true, true}};
    halves.pair[0].last = middle;
    halves.pair[1].first = static_cast<uint16_t>(middle + 1);
    return halves;
}

namespace {

class Search {
public:
    Search(std::span<const Line> memory, const Query& query, uint32_t stack_depth, Volumes volumes)
        : memory_(memory), query_(query), stack_depth_(stack_depth), volumes_(volumes) {
        answer_.squared = query.limit;
    }

    Answer run() {
        std::optional<SearchPair> pair = first_pair(query_);
        while (pair && answer_.stop == Stop::none) {
            pair = visit(*pair);
            if (!pair) pair = popped();
        }
        return answer_;
    }

private:
    /// Divides a pair, or compares its records. Returns the next pair.
    std::optional<SearchPair> visit(const SearchPair& pair) {
        const Division division = division_of(pair, query_.segment, volumes_);
        if (division == Division::none) {
            compare_records(pair);
            return {};
        }
        if (division == Division::way) {
            ++answer_.counts.splits;
            return nearer_of(split_at_middle(pair));
        }
        const bool of_work = division == Division::work;
        const Line* line = read((of_work ? pair.work : pair.tool).line(), of_work);
        if (!line) return {};
        ++answer_.counts.nodes;
        return nearer_of(halves_of_node(pair, division, node_in(*line, volumes_)));
    }

    std::optional<SearchPair> nearer_of(SplitPairs halves) {
        for (size_t i = 0; i < 2; ++i) {
            if (!halves.there[i]) continue;
            ++answer_.counts.box_tests;
            const SearchPair& half = halves.pair[i];
            const auto gap = squared_gap(half, offset_at(query_.segment, half.first),
                                         offset_at(query_.segment, half.last), volumes_);
            if (!gap) return stopped(Stop::out_of_range, 0);
            halves.pair[i].squared = *gap;
            halves.there[i] = *gap < answer_.squared;
        }
        const bool second =
            halves.there[1]
            && (!halves.there[0] || halves.pair[1].squared < halves.pair[0].squared);
        if (halves.there[0] && halves.there[1] && !push(halves.pair[second ? 0 : 1])) return {};
        if (!halves.there[0] && !halves.there[1]) return {};
        return halves.pair[second ? 1 : 0];
    }

    void compare_records(const SearchPair& pair) {
        const FixedVec offset = offset_at(query_.segment, pair.first);
        for (uint32_t i = 0; i < leaf_lines(pair.tool.count()); ++i)
            for (uint32_t j = 0; j < leaf_lines(pair.work.count()); ++j)
                if (!compare_lines(pair, offset, i, j)) return;
    }

    bool compare_lines(const SearchPair& pair, const FixedVec& offset, uint32_t i, uint32_t j) {
        const uint32_t tool_line = pair.tool.line() + i, work_line = pair.work.line() + j;
        const Line* tool = read(tool_line, false);
        const Line* work = tool ? read(work_line, true) : nullptr;
        if (!work) return false;
        const Records tools = records_in(*tool), works = records_in(*work);
        const uint32_t tool_count =
            std::min(records_per_line, pair.tool.count() - i * records_per_line);
        const uint32_t work_count =
            std::min(records_per_line, pair.work.count() - j * records_per_line);
        for (uint32_t a = 0; a < tool_count; ++a)
            for (uint32_t b = 0; b < work_count; ++b) {
                ++answer_.counts.pair_tests;
                const uint64_t squared = squared_distance(tools[a], offset, works[b]);
                if (squared >= answer_.squared) continue;
                answer_.found = true;
                answer_.squared = squared;
                answer_.tool_record = record_name(tool_line, a);
                answer_.work_record = record_name(work_line, b);
                answer_.sample = pair.first;
            }
        return true;
    }

    bool push(const SearchPair& pair) {
        if (stack_.size() == stack_depth_) {
            stopped(Stop::stack_overflow, 0);
            return false;
        }
        stack_.push_back(pair);
        answer_.counts.deepest =
            std::max(answer_.counts.deepest, static_cast<uint32_t>(stack_.size()));
        return true;
    }

    std::optional<SearchPair> popped() {
        while (!stack_.empty()) {
            const SearchPair pair = stack_.back();
            stack_.pop_back();
            if (pair.squared < answer_.squared) return pair;
        }
        return {};
    }

    const Line* read(uint32_t address, bool of_work) {
        if (address >= memory_.size()) {
            stopped(Stop::bad_address, address);
            return nullptr;
        }
        const Line& line = memory_[address];
        const Stop fault = fault_of(line, address, of_work ? query_.work_epoch : query_.tool_epoch);
        if (fault == Stop::none) return &line;
        stopped(fault, address);
        return nullptr;
    }

    std::optional<SearchPair> stopped(Stop stop, uint32_t line) {
        answer_.stop = stop;
        answer_.at_line = line;
        return {};
    }

    std::span<const Line> memory_;
    const Query& query_;
    uint32_t stack_depth_;
    Volumes volumes_;
    std::vector<SearchPair> stack_;
    Answer answer_;
};

} // namespace

Answer search(std::span<const Line> memory, const Query& query, uint32_t stack_depth,
              Volumes volumes) {
    return Search(memory, query, stack_depth, volumes).run();
}

Stop fault_of(const Line& line, uint32_t address, uint32_t epoch) {
    if (!is_intact(line, address)) return Stop::bad_check;
    return epoch_of(line) > epoch ? Stop::model_changed : Stop::none;
}

} // namespace hwsim
