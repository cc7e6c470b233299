#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace core {

/// Disjoint sets of the numbers 0 .. count - 1. The least member represents its set.
class UnionFind {
public:
    explicit UnionFind(size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), uint32_t{0});
    }
    uint32_t root(uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// Whether the numbers were in two sets, which are one now.
    bool join(uint32_t a, uint32_t b) {
        a = root(a);
        b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
        return a != b;
    }

private:
    std::vector<uint32_t> parent_;
};

} // namespace core
