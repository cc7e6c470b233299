#include "hwsim/memory_line.h"

#include <cassert>

namespace hwsim {
namespace {

constexpr uint32_t polynomial = 0xEDB8'8320U;
using CheckTable = std::array<std::array<uint32_t, 256>, 4>;

constexpr CheckTable make_check_table() {
    CheckTable table{};
    for (uint32_t byte = 0; byte < 256; ++byte) {
        uint32_t value = byte;
        for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1U) * polynomial);
        table[0][byte] = value;
    }
    for (size_t ahead = 1; ahead < 4; ++ahead)
        for (size_t byte = 0; byte < 256; ++byte) {
            const uint32_t before = table[ahead - 1][byte];
            table[ahead][byte] = (before >> 8) ^ table[0][before & 0xFFU];
        }
    return table;
}

constexpr CheckTable check_table = make_check_table();

uint32_t checked_on(uint32_t check, uint32_t word) {
    const uint32_t x = check ^ word;
    return check_table[3][x & 0xFFU] ^ check_table[2][(x >> 8) & 0xFFU]
           ^ check_table[1][(x >> 16) & 0xFFU] ^ check_table[0][x >> 24];
}

/// Writes the fields of a line one after the other, from its lowest bit.
class FieldWriter {
public:
    explicit FieldWriter(Line& line) : line_(line) {}

    void put(int32_t value, unsigned bits) {
        const uint64_t field = static_cast<uint32_t>(value) & ((uint64_t{1} << bits) - 1);
        const uint64_t shifted = field << (at_ % 32);
        line_.word[at_ / 32] |= static_cast<uint32_t>(shifted);
        if (shifted >> 32 != 0) line_.word[at_ / 32 + 1] |= static_cast<uint32_t>(shifted >> 32);
        at_ += bits;
    }

private:
    Line& line_;
    unsigned at_ = 0;
};

uint64_t bits_from(const Line& line, unsigned at) {
    const uint64_t both = line.word[at / 32] | uint64_t{line.word[at / 32 + 1]} << 32;
    return both >> (at % 32);
}

constexpr unsigned coordinate_bits = 24;
constexpr unsigned record_bits = 3 * coordinate_bits + 2 * Record::extent_bits;
constexpr size_t first_reference = 9;
constexpr size_t first_radius = 11;

int32_t coordinate_at(const Line& line, unsigned at) {
    return static_cast<int32_t>(static_cast<uint32_t>(bits_from(line, at)) << 8) >> 8;
}

int32_t extent_at(const Line& line, unsigned at) {
    return static_cast<int32_t>(bits_from(line, at) & Record::greatest_extent);
}

FixedVec vector_at(const Line& line, unsigned at) {
    return {coordinate_at(line, at), coordinate_at(line, at + coordinate_bits),
            coordinate_at(line, at + 2 * coordinate_bits)};
}

void put(FieldWriter& writer, const FixedVec& v) {
    for (const int32_t value : v) writer.put(value, coordinate_bits);
}

Line sealed(Line line, uint32_t epoch, uint32_t address) {
    line.word[Line::epoch_word] = epoch;
    line.word[Line::check_word] = check_of(line, address);
    return line;
}

} // namespace

uint32_t check_of(const Line& line, uint32_t address) {
    uint32_t check = checked_on(0xFFFF'FFFFU, address);
    for (size_t i = 0; i < Line::check_word; ++i) check = checked_on(check, line.word[i]);
    return ~check;
}

Line packed(const Node& node, uint32_t epoch, uint32_t address) {
    Line line;
    FieldWriter writer(line);
    for (const Volume& volume : node.volume) {
        put(writer, volume.box.min);
        put(writer, volume.box.max);
    }
    for (size_t i = 0; i < 2; ++i) {
        line.word[first_reference + i] = node.child[i].word;
        line.word[first_radius + i] = static_cast<uint32_t>(node.volume[i].radius);
    }
    return sealed(line, epoch, address);
}

Line packed(const Records& records, uint32_t epoch, uint32_t address) {
    Line line;
    FieldWriter writer(line);
    for (const Record& record : records) {
        put(writer, record.base);
        writer.put(record.run, Record::extent_bits);
        writer.put(record.half, Record::extent_bits);
    }
    return sealed(line, epoch, address);
}

Node node_in(const Line& line, Volumes volumes) {
    constexpr uint32_t greatest_radius = (1U << coordinate_bits) - 1; // of a sphere
    const uint32_t radius_mask =
        volumes == Volumes::spheres ? greatest_radius : uint32_t{Record::greatest_extent};
    Node node;
    for (unsigned i = 0; i < 2; ++i) {
        Volume& volume = node.volume[i];
        volume.box.min = vector_at(line, i * 6 * coordinate_bits);
        volume.box.max = vector_at(line, (i * 6 + 3) * coordinate_bits);
        volume.radius = static_cast<int32_t>(line.word[first_radius + i] & radius_mask);
        node.child[i] = {line.word[first_reference + i]};
    }
    return node;
}

Records records_in(const Line& line) {
    Records records;
    for (unsigned i = 0; i < records_per_line; ++i) {
        const unsigned at = i * record_bits;
        records[i].base = vector_at(line, at);
        records[i].run = extent_at(line, at + 3 * coordinate_bits);
        records[i].half = extent_at(line, at + 3 * coordinate_bits + Record::extent_bits);
    }
    return records;
}

std::optional<LineRun> take(LineSpace& space, uint32_t count) {
    assert(count >= 1 && count <= LineSpace::most);
    if (space.returned[count].empty() && space.end - space.next >= count) {
        space.next += count;
        return LineRun{space.next - count, count};
    }
    for (uint32_t length = count; length <= LineSpace::most; ++length) {
        std::vector<uint32_t>& runs = space.returned[length];
        if (runs.empty()) continue;
        const LineRun run{runs.back(), count};
        runs.pop_back();
        if (length > count) give_back(space, {run.first + count, length - count});
        return run;
    }
    return {};
}

void give_back(LineSpace& space, const LineRun& run) {
    assert(run.count >= 1 && run.count <= LineSpace::most);
    space.returned[run.count].push_back(run.first);
}

} // namespace hwsim
