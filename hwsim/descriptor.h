#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hwsim/memory_line.h"
#include "hwsim/segment.h"

namespace hwsim {

struct DeviceConfig;

/// What a descriptor orders. A line of zeros orders nothing and is refused.
enum class Order : uint8_t { none = 0, permit = 1, measure = 2, model = 3, copy = 4 };

/// Lines to be copied from the memory of the host to that of the device.
struct LineCopy {
    uint64_t from = 0; // byte address, a multiple of 64
    uint32_t line = 0, count = 0;

    bool operator==(const LineCopy&) const = default;
};

/// A descriptor takes one line of the ring, or more if a path has more than two pairs of models.
/// Word 15 is the check word of the other words and of the number of the line, which counts all
/// lines since reset: a line from an earlier round of the ring is not taken for a new one. Other
/// words and bits are ignored.
///
/// word  permit, measure                          model          copy
/// 0     bits 0-7 Order, 8-15 log2_steps,         Order          Order
///       16-23 number of pairs, 30 has a
///       deadline, 31 last of its segment
/// 1     sequence number                          sequence       first line
/// 2-4   start: x, y, z                           slot, header,  number of lines; address in the
///                                                epoch          host's memory: low, high word
/// 5-7   end: x, y, z
/// 8     deadline
/// 9-14  two pairs: slots (bits 0-4 tool, 5-9 work), threshold, epoch of the work
///
/// The next lines of a path have five pairs each, in words 0 to 14. Signed numbers are
/// sign-extended to 32 bits.
struct Descriptor {
    static constexpr uint32_t pairs_in_first = 2, pairs_in_next = 5, most_pairs = 255;

    Order order = Order::none;
    Segment segment;    // of a model the whole entry; of a path what its pairs have in common
    uint32_t pairs = 0; // of a path
    LineCopy copy;

    bool operator==(const Descriptor&) const = default;
};

/// The entry of a pair of a path: its place among the pairs of its line decides the words.
/// `is_first`: whether the line is the first of the descriptor.
Segment with_pair(Segment path, const Line& line, uint32_t place, bool is_first);

/// The first line of a descriptor, and its fault: none, bad_descriptor, out_of_range, or
/// bad_address. Check words are not compared.
struct DecodedDescriptor {
    Descriptor descriptor;
    Stop fault = Stop::none;
};
DecodedDescriptor descriptor_in(const Line& line, const DeviceConfig& config);

/// The fault of an entry: none or out_of_range. Only an entry that requests a permit can be the
/// last of its segment.
Stop fault_of(const Segment& entry);

/// The lines of a descriptor, without check words: of the pairs of a path, which differ only in
/// slots, threshold and epoch, and of which at most the last one is the last of its segment; or of
/// a model.
std::vector<Line> descriptor_of(std::span<const Segment> entries);
Line descriptor_of(const LineCopy& copy);

/// Writes the check word of the line with this number of the ring.
void seal(Line& line, uint32_t number);

} // namespace hwsim
