#pragma once

#include <optional>
#include <span>

#include "hwsim/segment.h"

namespace hwsim {

/// A part of the tool over a part of the way against a part of the work: what the search divides.
struct SearchPair {
    Reference tool, work;
    Volume tool_volume; // before it is moved
    Box work_box;
    uint16_t first = 0, last = 0; // samples
    uint64_t squared = 0;         // no records of the two are nearer than this

    bool operator==(const SearchPair&) const = default;
};

/// What is to be done with a pair.
enum class Division : uint8_t { tool, work, way, none };

/// The pair that a search begins with: both headers over the whole way.
SearchPair first_pair(const Query& query);

/// Divides what is largest: the tool's box, the work's box or the way, in this order where they are
/// equally large, so that a search begins with the tool's header. Leaves are not divided, nor is a
/// way that leads nowhere; when nothing is left to divide, the records are compared.
Division division_of(const SearchPair& pair, const Segment& segment);

/// The box test: a bound of the squared distance of a volume that goes from one offset to another
/// and a box at rest; nothing if what moves leaves the range of coordinates. Never more than the
/// squared distance of two records inside.
std::optional<uint64_t> squared_gap(const Volume& tool, const FixedVec& from, const FixedVec& to,
                                    const Box& work);

/// What comes of a division: two pairs, one if a child is missing. `squared` is not known yet.
struct Halves {
    std::array<SearchPair, 2> pair;
    std::array<bool, 2> there{};

    bool operator==(const Halves&) const = default;
};
Halves halves_of_node(const SearchPair& pair, Division division, const Node& node);
Halves halves_of_way(const SearchPair& pair);

/// Tests a half; nothing if it leaves the range of coordinates.
std::optional<uint64_t> squared_gap(const SearchPair& pair, const Segment& segment);

/// The functional model: what the device answers to a query, without its time.
///
/// A pair of parts whose bound is not below the best distance so far is left out. Of two halves the
/// one with the lesser bound is looked at first, the first one where they are equal; the other
/// waits on a stack. A pair of records becomes the nearest only if it is nearer than all before it,
/// so of equally near ones the first in this order is named.
///
/// Result: `squared` is the least squared distance of two records at any sample, or the query's
///         limit if none is below. Beyond `stack_depth` waiting pairs, or where the memory is at
///         fault, `stop` says why there is no answer.
Answer search(std::span<const Line> memory, const Query& query, uint32_t stack_depth = 64);

/// What is wrong with a line that a query wants to read, or none. `epoch` is that of its model:
/// a line that was written later belongs to another one.
Stop fault_of(const Line& line, uint32_t address, uint32_t epoch);

} // namespace hwsim
