#pragma once

#include <span>
#include <vector>

#include "hwsim/memory_line.h"
#include "hwsim/search.h"
#include "tests/bench/lone_thread.h"

namespace bench {

/// The device's search (hwsim/search.h) with any volumes in its nodes: `Rules` defines what is
/// divided and the bound of the distance of two parts; everything else is the same. Counts the time
/// of a thread alone. The memory must be intact; the stack is as deep as necessary.
template <typename Rules>
class VolumeSearch {
public:
    VolumeSearch(std::span<const hwsim::Line> memory, const hwsim::Query& query, const Rules& rules,
                 LoneThread& time)
        : memory_(memory), query_(query), rules_(rules), time_(time) {
        answer_.squared = query.limit;
    }

    hwsim::Answer run() {
        std::optional<Pair> pair = rules_.first_pair();
        while (pair && answer_.stop == hwsim::Stop::none) {
            pair = visit(*pair);
            if (!pair && answer_.stop == hwsim::Stop::none) pair = popped();
        }
        return answer_;
    }

private:
    using Pair = typename Rules::Pair;
    using SplitPairs = typename Rules::SplitPairs;

    std::optional<Pair> visit(const Pair& pair) {
        time_.ask_path_unit();
        const hwsim::Division division = rules_.division_of(pair);
        if (division == hwsim::Division::none) {
            compare(pair);
            return {};
        }
        if (division == hwsim::Division::way) {
            ++answer_.counts.splits;
            time_.ask_path_unit();
            return nearer_of(rules_.split_at_middle(pair));
        }
        ++answer_.counts.nodes;
        const uint32_t line = (division == hwsim::Division::work ? pair.work : pair.tool).line();
        time_.read(time_.nodes, line);
        const hwsim::Node node = hwsim::node_in(memory_[line]);
        return nearer_of(rules_.halves_of_node(pair, division, line, node));
    }

    std::optional<Pair> nearer_of(SplitPairs halves) {
        time_.test(uint32_t{halves[0].has_value()} + halves[1].has_value());
        for (std::optional<Pair>& half : halves) {
            if (!half) continue;
            ++answer_.counts.box_tests;
            if (!rules_.test(*half)) {
                answer_.stop = hwsim::Stop::out_of_range;
                return {};
            }
            if (!rules_.is_below(*half, answer_.squared)) half.reset();
        }
        if (halves[1] && (!halves[0] || rules_.bound_of(*halves[1]) < rules_.bound_of(*halves[0])))
            std::swap(halves[0], halves[1]);
        if (halves[1]) {
            stack_.push_back(*halves[1]);
            const auto size = static_cast<uint32_t>(stack_.size());
            answer_.counts.deepest = std::max(answer_.counts.deepest, size);
        }
        return halves[0];
    }

    void compare(const Pair& pair) {
        for (uint32_t i = 0; i < hwsim::leaf_lines(pair.tool.count()); ++i) {
            time_.read(time_.records, pair.tool.line() + i);
            for (uint32_t j = 0; j < hwsim::leaf_lines(pair.work.count()); ++j) {
                time_.read(time_.records, pair.work.line() + j);
                compare_lines(pair, i, j);
            }
        }
        time_.drain();
    }

    /// The records of line `line` of a leaf.
    std::span<const hwsim::Record> of_line(const hwsim::Records& records,
                                           const hwsim::Reference& leaf, uint32_t line) const {
        const uint32_t before = line * hwsim::records_per_line;
        return std::span(records).first(std::min(hwsim::records_per_line, leaf.count() - before));
    }

    void compare_lines(const Pair& pair, uint32_t i, uint32_t j) {
        const uint32_t tool_line = pair.tool.line() + i, work_line = pair.work.line() + j;
        const hwsim::Records tools = hwsim::records_in(memory_[tool_line]);
        const hwsim::Records works = hwsim::records_in(memory_[work_line]);
        const hwsim::FixedVec offset = hwsim::offset_at(query_.segment, pair.first);
        uint32_t a = hwsim::record_name(tool_line, 0);
        for (const hwsim::Record& tool : of_line(tools, pair.tool, i)) {
            uint32_t b = hwsim::record_name(work_line, 0);
            for (const hwsim::Record& work : of_line(works, pair.work, j))
                take(hwsim::squared_distance(tool, offset, work), a, b++, pair.first);
            ++a;
        }
    }

    void take(uint64_t squared, uint32_t tool, uint32_t work, uint16_t sample) {
        ++answer_.counts.pair_tests;
        time_.compare(1);
        if (squared >= answer_.squared) return;
        answer_.found = true;
        answer_.squared = squared;
        answer_.tool_record = tool;
        answer_.work_record = work;
        answer_.sample = sample;
    }

    std::optional<Pair> popped() {
        while (!stack_.empty()) {
            time_.pop(false);
            const Pair pair = stack_.back();
            stack_.pop_back();
            if (rules_.is_below(pair, answer_.squared)) return pair;
        }
        time_.pop(true);
        return {};
    }

    std::span<const hwsim::Line> memory_;
    const hwsim::Query& query_;
    const Rules& rules_;
    LoneThread& time_;
    std::vector<Pair> stack_;
    hwsim::Answer answer_;
};

} // namespace bench
