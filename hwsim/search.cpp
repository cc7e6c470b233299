#include "hwsim/search.h"

#include <vector>

#include "hwsim/pair_distance.h"

namespace hwsim {
namespace {

class Search {
public:
    Search(std::span<const Line> memory, const Query& query, uint32_t stack_depth)
        : memory_(memory), query_(query), stack_depth_(stack_depth) {
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
    /// Divides a pair, or compares its records. Returns the pair to go on with.
    std::optional<SearchPair> visit(const SearchPair& pair) {
        const Division division = division_of(pair, query_.segment);
        if (division == Division::none) {
            compare_records(pair);
            return {};
        }
        if (division == Division::way) {
            ++answer_.counts.splits;
            return nearer_of(halves_of_way(pair));
        }
        const bool of_work = division == Division::work;
        const Line* line = read((of_work ? pair.work : pair.tool).line(), of_work);
        if (!line) return {};
        ++answer_.counts.nodes;
        return nearer_of(halves_of_node(pair, division, node_in(*line)));
    }

    std::optional<SearchPair> nearer_of(Halves halves) {
        for (size_t i = 0; i < 2; ++i) {
            if (!halves.there[i]) continue;
            ++answer_.counts.box_tests;
            const auto gap = squared_gap(halves.pair[i], query_.segment);
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
    std::vector<SearchPair> stack_;
    Answer answer_;
};

} // namespace

Answer search(std::span<const Line> memory, const Query& query, uint32_t stack_depth) {
    return Search(memory, query, stack_depth).run();
}

Stop fault_of(const Line& line, uint32_t address, uint32_t epoch) {
    if (!is_intact(line, address)) return Stop::bad_check;
    return epoch_of(line) > epoch ? Stop::model_changed : Stop::none;
}

} // namespace hwsim
