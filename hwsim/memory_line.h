#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "hwsim/fixed_point.h"

namespace hwsim {

/// One beat of the memory: 512 bits. The last word is a check word over all others and the address,
/// the one before it the epoch in which the line was written.
struct alignas(64) Line {
    static constexpr size_t words = 16;
    static constexpr size_t epoch_word = 14;
    static constexpr size_t check_word = 15;
    std::array<uint32_t, words> word{};

    bool operator==(const Line&) const = default;
};

/// CRC-32 (reversed polynomial edb88320) of the address of the line and all words before the check
/// word. It detects any one, two or three wrong bits, every burst of 32, and a line from another
/// address.
uint32_t check_of(const Line& line, uint32_t address);

inline bool is_intact(const Line& line, uint32_t address) {
    return line.word[Line::check_word] == check_of(line, address);
}

/// A closed axis-aligned box.
struct Box {
    FixedVec min{}, max{};

    void extend(const Box& b) {
        for (size_t axis = 0; axis < 3; ++axis) {
            min[axis] = std::min(min[axis], b.min[axis]);
            max[axis] = std::max(max[axis], b.max[axis]);
        }
    }
    bool operator==(const Box&) const = default;
};

/// The range of coordinates.
constexpr Box everywhere{{least_coordinate, least_coordinate, least_coordinate},
                         {greatest_coordinate, greatest_coordinate, greatest_coordinate}};

/// What the nodes of models hold: upright boxes, or the spheres of Uddin & Yamazaki (2010). A
/// device has one kind; the circuit in rtl/ has boxes.
enum class Volumes : uint8_t { boxes, spheres };

constexpr const char* name_of(Volumes volumes) {
    return volumes == Volumes::spheres ? "spheres" : "boxes";
}

/// Bounding volume of a part of a model.
///
/// Boxes:   all points within `radius`, horizontally, of a box. On the tool side the box is around
///          the axes of cylinders; on the work side the radius is 0.
/// Spheres: both corners of the box are the centre.
struct Volume {
    Box box;
    int32_t radius = 0;

    void extend(const Volume& v) {
        box.extend(v.box);
        radius = std::max(radius, v.radius);
    }
    bool operator==(const Volume&) const = default;
};

/// The side of a model.
enum class Side : uint8_t { tool, work };

/// A point of a model with an extent: from `base` up by `run`, and sideways by `half`. On the tool
/// side it is an upright cylinder of that radius; on the work side an upright post with a square
/// section of that half side. Both 0: a bare point.
struct Record {
    static constexpr int extent_bits = 20;
    static constexpr int32_t greatest_extent = (1 << extent_bits) - 1;

    FixedVec base{}; // x and y of the axis, z of the lower end
    int32_t run = 0;
    int32_t half = 0;

    bool operator==(const Record&) const = default;
};

/// The box around a record of either side.
inline Box box_of(const Record& r) {
    return {{r.base[0] - r.half, r.base[1] - r.half, r.base[2]},
            {r.base[0] + r.half, r.base[1] + r.half, r.base[2] + r.run}};
}

inline Volume volume_of(const Record& r, Side side) {
    if (side == Side::work) return {box_of(r), 0};
    return {{r.base, {r.base[0], r.base[1], r.base[2] + r.run}}, r.half};
}

/// A reference of a node: to another node, to a leaf of up to 32 records in consecutive lines, or
/// empty.
struct Reference {
    static constexpr uint32_t line_bits = 26;
    static constexpr uint32_t leaf_flag = 0x8000'0000U;
    static constexpr uint32_t most_records = 32;
    static constexpr uint32_t none_word = 0x7FFF'FFFFU;

    uint32_t word = none_word;

    static constexpr Reference node(uint32_t line) { return {line}; }
    static constexpr Reference leaf(uint32_t line, uint32_t count) {
        return {leaf_flag | ((count - 1) << line_bits) | line};
    }
    constexpr bool is_none() const { return word == none_word; }
    constexpr bool is_leaf() const { return (word & leaf_flag) != 0; }
    constexpr uint32_t line() const { return word & ((1U << line_bits) - 1); }
    constexpr uint32_t count() const { return ((word >> line_bits) & 0x1FU) + 1; }
    bool operator==(const Reference&) const = default;
};

/// Two children and their bounding volumes. The header of a model is a node whose first child is
/// its root; the second child is empty.
struct Node {
    std::array<Volume, 2> volume{};
    std::array<Reference, 2> child{};

    bool operator==(const Node&) const = default;
};

constexpr uint32_t records_per_line = 4;
using Records = std::array<Record, records_per_line>;

/// The number of lines of a leaf with `count` records.
constexpr uint32_t leaf_lines(uint32_t count) {
    return (count + records_per_line - 1) / records_per_line;
}

/// The number of a record, from its line and its position in the line.
constexpr uint32_t record_name(uint32_t line, uint32_t index) {
    return line * records_per_line + index;
}

/// Node:   words 0-8 the boxes, 24 bits a number (first box, then second; min x y z, max x y z),
///         words 9-10 the references, 11-12 the radii, of which 20 bits count for boxes and 24 for
///         spheres, 13 zero.
/// Leaf:   words 0-13 four records of 112 bits: x, y, z (24 each), run, half (20 each).
/// Bits count from the lowest of word 0; signed numbers are two's complement.
Line packed(const Node& node, uint32_t epoch, uint32_t address);
Line packed(const Records& records, uint32_t epoch, uint32_t address);
Node node_in(const Line& line, Volumes volumes = Volumes::boxes);
Records records_in(const Line& line);

inline uint32_t epoch_of(const Line& line) { return line.word[Line::epoch_word]; }

/// Consecutive lines of memory.
struct LineRun {
    uint32_t first = 0, count = 0;

    bool operator==(const LineRun&) const = default;
};

/// The free lines of the device memory. A plain value, kept by the host.
struct LineSpace {
    static constexpr uint32_t most = leaf_lines(Reference::most_records); // lines of a run

    uint32_t next = 0, end = 0;                           // never used yet
    std::array<std::vector<uint32_t>, most + 1> returned; // by length
};

/// Allocates consecutive lines; empty if the memory is full. Longer returned runs are split before
/// the memory counts as full.
std::optional<LineRun> take(LineSpace& space, uint32_t count);

void give_back(LineSpace& space, const LineRun& run);

/// The least integer whose square is at least `square`, for squares below 2^50. In the circuit: 13
/// stages of two bits.
inline int64_t root_up(int64_t square) {
    // The square root of a double is correctly rounded, so one step either way makes it exact.
    auto root = static_cast<int64_t>(std::sqrt(static_cast<double>(square)));
    while (root * root < square) ++root;
    while (root > 0 && (root - 1) * (root - 1) >= square) --root;
    return root;
}

/// The squared distance of two records, given the gaps between axis and post along X, Y and Z and
/// the radius of the cylinder. Exact for radius 0; otherwise the root is rounded up, so the
/// distance is less than one step too large. It increases with each gap and decreases with the
/// radius.
inline uint64_t squared_distance(const std::array<int64_t, 3>& gap, int64_t radius) {
    int64_t level = gap[0] * gap[0] + gap[1] * gap[1];
    if (radius > 0) {
        const int64_t apart = std::max(root_up(level) - radius, int64_t{0});
        level = apart * apart;
    }
    return static_cast<uint64_t>(level + gap[2] * gap[2]);
}

/// The squared distance between a record of the tool side, moved by `offset`, and one of the work
/// side: between an upright cylinder and an upright square post.
inline uint64_t squared_distance(const Record& tool, const FixedVec& offset, const Record& work) {
    const auto sideways = [&](size_t axis) {
        const int64_t apart = int64_t{tool.base[axis]} + offset[axis] - work.base[axis];
        return std::max(std::abs(apart) - work.half, int64_t{0});
    };
    const int64_t foot = int64_t{tool.base[2]} + offset[2];
    const int64_t below = work.base[2] - (foot + tool.run);
    const int64_t above = foot - (int64_t{work.base[2]} + work.run);
    return squared_distance({sideways(0), sideways(1), std::max({below, above, int64_t{0}})},
                            tool.half);
}

} // namespace hwsim
