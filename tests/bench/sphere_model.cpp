#include "tests/bench/sphere_model.h"

#include "hwsim/memory_line.h"

namespace bench {
namespace {

using hwsim::FixedVec;
using hwsim::Record;
using hwsim::Reference;
using hwsim::Side;

/// The distance of the farther of two ends from a point on a line.
int64_t farthest(int64_t low, int64_t high, int64_t from) {
    return std::max(std::abs(low - from), std::abs(high - from));
}

/// The squared distance from a point to the farthest point of a record, not rounded down.
int64_t squared_reach(const Record& r, Side side, const FixedVec& from) {
    const int64_t up = farthest(r.base[2], int64_t{r.base[2]} + r.run, from[2]);
    if (side == Side::work) {
        const int64_t x =
            farthest(int64_t{r.base[0]} - r.half, int64_t{r.base[0]} + r.half, from[0]);
        const int64_t y =
            farthest(int64_t{r.base[1]} - r.half, int64_t{r.base[1]} + r.half, from[1]);
        return x * x + y * y + up * up;
    }
    const int64_t x = int64_t{r.base[0]} - from[0], y = int64_t{r.base[1]} - from[1];
    const int64_t level = hwsim::root_up(x * x + y * y) + r.half;
    return level * level + up * up;
}

/// Traverses a tree from its leaves upwards. The records of a branch are contiguous in `records_`.
class TreeWalk {
public:
    TreeWalk(SphereTable& table, std::span<const hwsim::Line> memory, Side side)
        : table_(table), memory_(memory), side_(side) {}

    Sphere visit(Reference reference) {
        const size_t first = records_.size();
        if (reference.is_leaf())
            take_leaf(reference);
        else
            take_node(reference.line());
        return sphere_round(std::span(records_).subspan(first), side_);
    }

    void take_node(uint32_t line) {
        const hwsim::Node node = hwsim::node_in(memory_[line]);
        for (size_t i = 0; i < 2; ++i)
            if (!node.child[i].is_none()) table_[line][i] = visit(node.child[i]);
    }

private:
    void take_leaf(Reference leaf) {
        for (uint32_t i = 0; i < leaf.count(); ++i) {
            const auto four = hwsim::records_in(memory_[leaf.line() + i / hwsim::records_per_line]);
            records_.push_back(four[i % hwsim::records_per_line]);
        }
    }

    SphereTable& table_;
    std::span<const hwsim::Line> memory_;
    Side side_;
    std::vector<Record> records_;
};

} // namespace

Sphere sphere_round(std::span<const Record> records, Side side) {
    hwsim::Box box = hwsim::box_of(records[0]);
    for (const Record& record : records) box.extend(hwsim::box_of(record));
    Sphere sphere;
    for (size_t axis = 0; axis < 3; ++axis)
        sphere.centre[axis] = static_cast<int32_t>((int64_t{box.min[axis]} + box.max[axis]) >> 1);
    int64_t squared = 0;
    for (const Record& record : records)
        squared = std::max(squared, squared_reach(record, side, sphere.centre));
    sphere.radius = static_cast<int32_t>(hwsim::root_up(squared));
    return sphere;
}

void add_spheres(SphereTable& table, std::span<const hwsim::Line> memory, uint32_t header,
                 Side side) {
    table.resize(memory.size());
    TreeWalk(table, memory, side).take_node(header);
}

} // namespace bench
