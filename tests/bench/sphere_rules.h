#pragma once

#include <optional>
#include <span>

#include "hwsim/search.h"
#include "tests/bench/sphere_model.h"

namespace bench {

/// What a search by spheres divides, as SearchPair is for boxes.
struct SpherePair {
    hwsim::Reference tool, work;
    Sphere tool_sphere, work_sphere; // the tool's before it is moved
    uint16_t first = 0, last = 0;    // samples
    uint64_t bound = 0;              // no records of the two are nearer than this many steps
    uint64_t apart = 0;              // squared, of the centres
};

/// A search by the paper's spheres, along a way. A stretch of the way is a sphere, too: the tool's
/// sphere goes to its middle, and grows by half its length.
///
/// The test: floor(root(squared distance of the centres)) less all three radii, never below 0. It
/// goes on if the square of that is below the best squared distance. In a circuit the best is kept
/// as a root, rounded up, once for each that is found, and bounds are compared with it: for
/// integers that is the same, and no square has to be taken.
class SphereRules {
public:
    using Pair = SpherePair;
    using Halves = std::array<std::optional<Pair>, 2>;

    SphereRules(std::span<const hwsim::Line> memory, const SphereTable& table,
                const hwsim::Query& query);

    Pair first_pair() const;

    /// What is largest, as with boxes: radii and half the way are compared.
    hwsim::Division division_of(const Pair& pair) const;
    Halves halves_of_node(const Pair& pair, hwsim::Division division, uint32_t line,
                          const hwsim::Node& node) const;
    static Halves halves_of_way(const Pair& pair);

    /// Sets the bound; false if the tool leaves the range of coordinates on its way.
    bool test(Pair& pair) const;
    static uint64_t bound_of(const Pair& pair) { return pair.bound; }
    static bool is_below(const Pair& pair, uint64_t squared) {
        return pair.bound * pair.bound < squared;
    }

    /// The middle of a stretch of samples, and a radius that holds all places of the tool's origin
    /// at them.
    Sphere stretch(uint32_t first, uint32_t last) const;

private:
    const SphereTable& table_;
    const hwsim::Query& query_;
    int64_t way_ = 0; // its length, rounded up: a word of the segment that the host works out
    bool in_range_ = true;
};

/// The same without a root in the test: squared distance of the centres against the square of best
/// and radii. For integers that is the same as well, as long as the best is not 0. But which of two
/// halves is nearer it does not say, so that with the nearer centres goes first.
class RootlessSphereRules : public SphereRules {
public:
    using SphereRules::SphereRules;
    static uint64_t bound_of(const Pair& pair) { return pair.apart; }
};

} // namespace bench
