#include "core/geom/mesh_sides.h"

#include <algorithm>

namespace core {
namespace {

bool is_usable(const Mesh& mesh, const Mesh::Corners& t) {
    for (const uint32_t v : t)
        if (v >= mesh.vertices.size() || !is_finite(mesh.vertices[v])) return false;
    return t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
}

/// All sides, those with the same lower end together.
struct SideBuckets {
    struct Entry {
        uint32_t high, side;
    };
    std::vector<uint32_t> starts; // of the bucket of each vertex, and the end of the last
    std::vector<Entry> entries;
};

SideBuckets bucketed(const Mesh& mesh, const std::vector<bool>& usable) {
    SideBuckets buckets;
    buckets.starts.assign(mesh.vertices.size() + 1, 0);
    const auto for_each_side = [&](const auto& act) {
        for (uint32_t side = 0; side < 3 * mesh.triangles.size(); ++side) {
            if (!usable[side / 3]) continue;
            const uint32_t a = start_of(mesh, side), b = end_of(mesh, side);
            act(std::min(a, b), std::max(a, b), side);
        }
    };
    for_each_side([&](uint32_t low, uint32_t, uint32_t) { ++buckets.starts[low + 1]; });
    for (size_t v = 1; v < buckets.starts.size(); ++v) buckets.starts[v] += buckets.starts[v - 1];
    buckets.entries.resize(buckets.starts.back());
    std::vector<uint32_t> at(buckets.starts.begin(), buckets.starts.end() - 1);
    for_each_side([&](uint32_t low, uint32_t high, uint32_t side) {
        buckets.entries[at[low]++] = {high, side};
    });
    return buckets;
}

/// Joins the sides of a bucket that share their higher end with exactly one other.
void join(const Mesh& mesh, std::span<SideBuckets::Entry> bucket, std::vector<uint32_t>& mates) {
    std::sort(bucket.begin(), bucket.end(), [](const auto& a, const auto& b) {
        return a.high != b.high ? a.high < b.high : a.side < b.side;
    });
    for (size_t i = 0, end = 0; i < bucket.size(); i = end) {
        while (end < bucket.size() && bucket[end].high == bucket[i].high) ++end;
        if (end - i != 2) continue;
        const uint32_t a = bucket[i].side, b = bucket[i + 1].side;
        if (start_of(mesh, a) != end_of(mesh, b)) continue;
        mates[a] = b;
        mates[b] = a;
    }
}

/// The side after `side` on the border of a set: turns round the end of `side` within the set.
template <typename IsBorder>
uint32_t next_on_border(const MeshSides& sides, uint32_t side, const IsBorder& is_border) {
    uint32_t next = MeshSides::next(side);
    while (!is_border(next)) next = MeshSides::next(sides.mates[next]);
    return next;
}

} // namespace

MeshSides sides_of(const Mesh& mesh) {
    MeshSides sides;
    sides.mates.assign(3 * mesh.triangles.size(), no_index);
    for (const Mesh::Corners& t : mesh.triangles) sides.usable.push_back(is_usable(mesh, t));
    SideBuckets buckets = bucketed(mesh, sides.usable);
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
        const uint32_t first = buckets.starts[v], end = buckets.starts[v + 1];
        join(mesh, std::span(buckets.entries).subspan(first, end - first), sides.mates);
    }
    return sides;
}

std::vector<std::vector<uint32_t>> border_loops(const MeshSides& sides,
                                                std::span<const uint32_t> triangles,
                                                const std::vector<uint32_t>& labels,
                                                uint32_t label) {
    const auto is_border = [&](uint32_t side) {
        return sides.mates[side] == no_index || labels[sides.mates[side] / 3] != label;
    };
    std::vector<uint32_t> borders;
    for (const uint32_t t : triangles)
        for (uint32_t side = 3 * t; side < 3 * t + 3; ++side)
            if (is_border(side)) borders.push_back(side);
    std::sort(borders.begin(), borders.end());
    // The sides around a vertex are turned through in one sense, so each border side has exactly
    // one successor and one predecessor: the loops are the cycles of a permutation.
    std::vector<bool> used(borders.size(), false);
    std::vector<std::vector<uint32_t>> loops;
    for (size_t i = 0; i < borders.size(); ++i) {
        if (used[i]) continue;
        loops.emplace_back();
        for (uint32_t side = borders[i];;) {
            const size_t at = static_cast<size_t>(
                std::lower_bound(borders.begin(), borders.end(), side) - borders.begin());
            if (used[at]) break;
            used[at] = true;
            loops.back().push_back(side);
            side = next_on_border(sides, side, is_border);
        }
    }
    return loops;
}

} // namespace core
