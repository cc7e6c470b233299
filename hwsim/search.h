#pragma once

#include <optional>
#include <span>

#include "hwsim/segment.h"

namespace hwsim {

/// A part of the tool over a part of the path against a part of the work: the unit that the search
/// divides.
struct SearchPair {
    Reference tool, work;
    Volume tool_volume; // before the offset is added
    Box work_box;
    int32_t work_radius = 0;      // of a sphere
    uint16_t first = 0, last = 0; // samples
    uint64_t squared = 0;         // lower bound of the squared distance of their records

    bool operator==(const SearchPair&) const = default;
};

/// The part of a pair that is divided.
enum class Division : uint8_t { tool, work, way, none };

/// The first pair of a search: both headers over the whole path.
SearchPair first_pair(const Query& query);

/// Selects the largest: the volume of the tool, that of the work or the path, in this order if
/// equal, so a search begins with the header of the tool. The size of a box is its longest side,
/// that of a sphere its diameter. Leaves are not divided, nor is a path of length 0; if nothing can
/// be divided, the records are compared.
Division division_of(const SearchPair& pair, const Segment& segment, Volumes volumes);

/// The box test: a lower bound of the squared distance between a volume that moves from one offset
/// to another and a box at rest; empty if the volume leaves the range of coordinates. Never more
/// than the squared distance of two records inside.
std::optional<uint64_t> squared_gap(const Volume& tool, const FixedVec& from, const FixedVec& to,
                                    const Box& work);

/// The result of a division: two pairs, or one if a child is missing. `squared` is not known yet.
struct SplitPairs {
    std::array<SearchPair, 2> pair;
    std::array<bool, 2> there{};

    bool operator==(const SplitPairs&) const = default;
};
SplitPairs halves_of_node(const SearchPair& pair, Division division, const Node& node);
SplitPairs split_at_middle(const SearchPair& pair);

/// The test of spheres, as the box test: root(d2) - r, where d is the distance between the centre
/// of the work and the box around the centre of the tool on its way, r the sum of both radii, and
/// the root is rounded down.
std::optional<uint64_t> squared_gap_of_spheres(const Volume& tool, const FixedVec& from,
                                               const FixedVec& to, const Volume& work);

/// Tests a half whose offset goes from one to another; empty if it leaves the range of coordinates.
std::optional<uint64_t> squared_gap(const SearchPair& pair, const FixedVec& from,
                                    const FixedVec& to, Volumes volumes);

/// The functional model: the answer of the device to a query, without timing.
///
/// Pairs whose bound is not below the best distance so far are skipped. Of two halves, the one with
/// the lower bound is searched first, the first one if equal; the other waits on a stack. A pair of
/// records becomes the nearest only if it is nearer than all before it, so of equally near pairs
/// the first in this order is returned.
///
/// Result:  `squared` is the least squared distance of two records at any sample, or the limit of
///          the query if none is below it. If more than `stack_depth` pairs wait, or the memory is
///          faulty, `stop` gives the reason.
Answer search(std::span<const Line> memory, const Query& query, uint32_t stack_depth = 64,
              Volumes volumes = Volumes::boxes);

/// The fault of a line that a query wants to read, or none. `epoch` is that of its model: a line
/// written later belongs to another model.
Stop fault_of(const Line& line, uint32_t address, uint32_t epoch);

} // namespace hwsim
