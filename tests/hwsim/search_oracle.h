#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "hwsim/registers.h"
#include "hwsim/search.h"

namespace hwsim {

/// The least squared distance over all samples and all pairs of records, the limit if none is
/// below.
inline uint64_t least_of_all(std::span<const Record> tools, std::span<const Record> works,
                             const Segment& segment, uint64_t limit) {
    for (uint32_t k = 0; k <= (1U << segment.log2_steps); ++k)
        for (const Record& tool : tools)
            for (const Record& work : works)
                limit = std::min(limit, squared_distance(tool, offset_at(segment, k), work));
    return limit;
}

/// The search as its description has it, by recursion.
class SearchOracle {
public:
    SearchOracle(std::span<const Line> memory, const Query& query)
        : memory_(memory), query_(query) {
        answer.squared = query.limit;
        visit({Reference::node(query.tool_header), {everywhere, 0}},
              {Reference::node(query.work_header), {everywhere, 0}}, 0,
              1 << query.segment.log2_steps, 0);
    }

    Answer answer;

private:
    using Wide = int64_t;
    struct Part {
        Reference reference;
        Volume volume;
    };
    struct Half {
        Part tool, work;
        int first, last;
        Wide gap = 0;
    };

    static Wide size_of(const Part& part) {
        if (part.reference.is_leaf()) return -1;
        Wide size = 0;
        for (size_t axis = 0; axis < 3; ++axis) {
            const Wide aside = axis < 2 ? 2 * part.volume.radius : 0;
            size = std::max<Wide>(size, Wide(part.volume.box.max[axis]) - part.volume.box.min[axis]
                                            + aside);
        }
        return size;
    }

    FixedVec position(int k) const { return offset_at(query_.segment, static_cast<uint32_t>(k)); }

    Wide gap_of(const Half& half) const {
        const FixedVec a = position(half.first), b = position(half.last);
        std::array<Wide, 3> gap{};
        for (size_t axis = 0; axis < 3; ++axis) {
            const Box& tool = half.tool.volume.box;
            const Box& work = half.work.volume.box;
            const Wide min = Wide(tool.min[axis]) + std::min(a[axis], b[axis]);
            const Wide max = Wide(tool.max[axis]) + std::max(a[axis], b[axis]);
            if (min > work.max[axis]) gap[axis] = min - work.max[axis];
            if (max < work.min[axis]) gap[axis] = work.min[axis] - max;
        }
        Wide level = gap[0] * gap[0] + gap[1] * gap[1];
        if (half.tool.volume.radius > 0) {
            const Wide beside = std::max<Wide>(least_root(level) - half.tool.volume.radius, 0);
            level = beside * beside;
        }
        return level + gap[2] * gap[2];
    }

    /// The least number whose square is enough, by halving.
    static Wide least_root(Wide square) {
        Wide low = 0, high = Wide(1) << 25;
        while (low < high) {
            const Wide middle = (low + high) / 2;
            (middle * middle >= square ? high : low) = middle + (middle * middle >= square ? 0 : 1);
        }
        return low;
    }

    void visit(const Part& tool, const Part& work, int first, int last, uint32_t waiting) {
        const FixedVec a = position(first), b = position(last);
        Wide way = 0;
        for (size_t axis = 0; axis < 3; ++axis)
            way = std::max<Wide>(way, b[axis] > a[axis] ? Wide(b[axis]) - a[axis]
                                                        : Wide(a[axis]) - b[axis]);
        const Wide of_tool = size_of(tool), of_work = size_of(work);
        if (of_tool < 0 && of_work < 0 && way == 0) return compare(tool, work, first);
        std::vector<Half> halves;
        if (way > of_tool && way > of_work) {
            ++answer.counts.splits;
            const int middle = (first + last) / 2;
            halves = {{tool, work, first, middle}, {tool, work, middle + 1, last}};
        } else {
            ++answer.counts.nodes;
            const bool is_tool = of_tool >= of_work;
            const Node node = node_in(memory_[(is_tool ? tool : work).reference.line()]);
            for (size_t i = 0; i < 2; ++i) {
                const Part part{node.child[i], node.volume[i]};
                if (part.reference.is_none()) continue;
                halves.push_back({is_tool ? part : tool, is_tool ? work : part, first, last});
            }
        }
        follow(std::move(halves), waiting);
    }

    void follow(std::vector<Half> halves, uint32_t waiting) {
        for (Half& half : halves) half.gap = gap_of(half);
        answer.counts.box_tests += static_cast<uint32_t>(halves.size());
        std::erase_if(halves, [&](const Half& half) { return half.gap >= Wide(answer.squared); });
        std::stable_sort(halves.begin(), halves.end(),
                         [](const Half& a, const Half& b) { return a.gap < b.gap; });
        for (size_t i = 0; i < halves.size(); ++i) {
            const Half& half = halves[i];
            if (half.gap >= Wide(answer.squared)) continue;
            const auto behind = static_cast<uint32_t>(halves.size() - 1 - i);
            answer.counts.deepest = std::max(answer.counts.deepest, waiting + behind);
            visit(half.tool, half.work, half.first, half.last, waiting + behind);
        }
    }

    void compare(const Part& tool, const Part& work, int sample) {
        for (uint32_t line_a = 0; line_a * 4 < tool.reference.count(); ++line_a)
            for (uint32_t line_b = 0; line_b * 4 < work.reference.count(); ++line_b)
                for (uint32_t a = line_a * 4; a < std::min(line_a * 4 + 4, tool.reference.count());
                     ++a)
                    for (uint32_t b = line_b * 4;
                         b < std::min(line_b * 4 + 4, work.reference.count()); ++b)
                        compare(tool.reference.line() * 4 + a, work.reference.line() * 4 + b,
                                sample);
    }

    void compare(uint32_t tool, uint32_t work, int sample) {
        ++answer.counts.pair_tests;
        const Record a = records_in(memory_[tool / 4])[tool % 4];
        const Record b = records_in(memory_[work / 4])[work % 4];
        const uint64_t squared = squared_distance(a, position(sample), b);
        if (squared >= answer.squared) return;
        answer.found = true;
        answer.squared = squared;
        answer.tool_record = tool;
        answer.work_record = work;
        answer.sample = static_cast<uint16_t>(sample);
    }

    std::span<const Line> memory_;
    const Query& query_;
};

} // namespace hwsim
