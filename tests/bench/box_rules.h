#pragma once

#include <optional>

#include "hwsim/search.h"

namespace bench {

/// A search with the device's own volumes, for comparison with spheres.
class BoxRules {
public:
    using Pair = hwsim::SearchPair;
    using SplitPairs = std::array<std::optional<Pair>, 2>;

    explicit BoxRules(const hwsim::Query& query) : query_(query) {}

    Pair first_pair() const { return hwsim::first_pair(query_); }
    hwsim::Division division_of(const Pair& pair) const {
        return hwsim::division_of(pair, query_.segment);
    }
    static SplitPairs halves_of_node(const Pair& pair, hwsim::Division division, uint32_t /*line*/,
                                     const hwsim::Node& node) {
        return those_there(hwsim::halves_of_node(pair, division, node));
    }
    static SplitPairs split_at_middle(const Pair& pair) {
        return those_there(hwsim::split_at_middle(pair));
    }
    bool test(Pair& pair) const {
        const auto gap = hwsim::squared_gap(pair, query_.segment);
        pair.squared = gap.value_or(0);
        return gap.has_value();
    }
    static bool is_below(const Pair& pair, uint64_t squared) { return pair.squared < squared; }
    static uint64_t bound_of(const Pair& pair) { return pair.squared; }

private:
    static SplitPairs those_there(const hwsim::SplitPairs& halves) {
        SplitPairs there;
        for (size_t i = 0; i < 2; ++i)
            if (halves.there[i]) there[i] = halves.pair[i];
        return there;
    }

    const hwsim::Query& query_;
};

} // namespace bench
