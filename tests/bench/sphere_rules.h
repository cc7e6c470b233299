#pragma once

#include <optional>
#include <span>

#include "hwsim/search.h"
#include "tests/bench/sphere_model.h"

namespace bench {

/// The pair divided by a search with spheres, like SearchPair for boxes.
struct SpherePair {
    hwsim::Reference tool, work;
    Sphere tool_sphere, work_sphere; // the tool's sphere before it is moved
    uint16_t first = 0, last = 0;    // samples
    uint64_t bound = 0;              // no records of the two are closer than this, steps
    uint64_t apart = 0;              // squared distance of the centres
};

/// A search with the paper's spheres along a path. A stretch of the path is a sphere too: the
/// tool's sphere moves to its middle and grows by half its length.
///
/// The test: floor(root(squared distance of the centres)) minus all three radii, at least 0. The
/// search continues if its square is below the best squared distance. In a circuit the best is
/// stored as a root, rounded up, once for each improvement, and bounds are compared with it: for
/// integers this is equivalent, and needs no square.
class SphereRules {
public:
    using Pair = SpherePair;
    using SplitPairs = std::array<std::optional<Pair>, 2>;

    SphereRules(std::span<const hwsim::Line> memory, const SphereTable& table,
                const hwsim::Query& query);

    Pair first_pair() const;

    /// The largest part, as with boxes: compares radii and half the path.
    hwsim::Division division_of(const Pair& pair) const;
    SplitPairs halves_of_node(const Pair& pair, hwsim::Division division, uint32_t line,
                              const hwsim::Node& node) const;
    static SplitPairs split_at_middle(const Pair& pair);

    /// Sets the bound; false if the tool leaves the range of coordinates on its path.
    bool test(Pair& pair) const;
    static uint64_t bound_of(const Pair& pair) { return pair.bound; }
    static bool is_below(const Pair& pair, uint64_t squared) {
        return pair.bound * pair.bound < squared;
    }

    /// The middle of a stretch of samples, and a radius that contains all positions of the tool's
    /// origin at them.
    Sphere stretch(uint32_t first, uint32_t last) const;

private:
    const SphereTable& table_;
    const hwsim::Query& query_;
    int64_t way_ = 0; // its length, rounded up: a word of the segment calculated by the host
    bool in_range_ = true;
};

/// The same without a root in the test: compares the squared distance of the centres with the
/// square of best plus radii. For integers this is equivalent as long as the best is not 0. It does
/// not tell which of two halves is nearer, so the one with the nearer centres goes first.
class RootlessSphereRules : public SphereRules {
public:
    using SphereRules::SphereRules;
    static uint64_t bound_of(const Pair& pair) { return pair.apart; }
};

} // namespace bench
