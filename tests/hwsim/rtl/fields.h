#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hwsim/ring_unit.h"
#include "hwsim/search_element.h"

namespace hwsim::rtl {

/// The fields of a packed structure of the circuit, from its lowest bit.
class Fields {
public:
    void put(int64_t value, unsigned bits) {
        for (unsigned i = 0; i < bits; ++i, ++size_) {
            if (size_ % 32 == 0) words_.push_back(0);
            words_.back() |= static_cast<uint32_t>((value >> i) & 1) << (size_ % 32);
        }
    }
    void put(const FixedVec& v) {
        for (const int32_t value : v) put(value, 24);
    }
    void put(const Box& box) {
        put(box.min);
        put(box.max);
    }
    void put(const Volume& volume) {
        put(volume.box);
        put(volume.radius, Record::extent_bits);
    }
    void put(const Record& record) {
        put(record.base);
        put(record.run, Record::extent_bits);
        put(record.half, Record::extent_bits);
    }
    /// Of a segment: its path.
    void put(const Segment& segment) {
        put(segment.log2_steps, 4);
        put(segment.start);
        put(segment.end);
    }
    void put(const Query& query) {
        put(query.segment);
        put(query.tool_header, Reference::line_bits);
        put(query.work_header, Reference::line_bits);
        put(query.tool_epoch, 32);
        put(query.work_epoch, 32);
        put(static_cast<int64_t>(query.limit), 51);
    }
    void put(const Answer& answer) {
        put(answer.counts.deepest, 7);
        for (const uint32_t count : {answer.counts.pair_tests, answer.counts.box_tests,
                                     answer.counts.splits, answer.counts.nodes})
            put(count, 32);
        put(answer.sample, 13);
        put(answer.work_record, 28);
        put(answer.tool_record, 28);
        put(static_cast<int64_t>(answer.squared), 51);
        put(answer.found, 1);
        put(answer.at_line, 27);
        put(static_cast<int64_t>(answer.stop), 4);
    }
    void put(const OrderedEntry& entry) {
        const Segment& s = entry.segment;
        put(s.sequence, 32);
        put(static_cast<int64_t>(s.kind), 2);
        put(s.tool_slot, 5);
        put(s.work_slot, 5);
        put(s);
        put(s.threshold, 23);
        put(s.work_epoch, 32);
        put(s.model_header, Reference::line_bits);
        put(s.last, 1);
        put(s.is_timed, 1);
        put(s.deadline, 32);
        put(static_cast<int64_t>(entry.asked), 64);
        put(static_cast<int64_t>(entry.lines), 64);
    }

    const std::vector<uint32_t>& words() const { return words_; }

private:
    std::vector<uint32_t> words_;
    unsigned size_ = 0;
};

/// Sets an input of more than 64 bits.
template <typename Port>
void set(Port& port, const Fields& fields) {
    for (size_t i = 0; i < fields.words().size(); ++i) port[i] = fields.words()[i];
}

/// Whether an output of more than 64 bits holds these fields.
template <typename Port>
bool holds(const Port& port, const Fields& fields) {
    for (size_t i = 0; i < fields.words().size(); ++i)
        if (port[i] != fields.words()[i]) return false;
    return true;
}

/// A field of an output of more than 64 bits.
template <typename Port>
uint64_t field(const Port& port, unsigned at, unsigned bits) {
    uint64_t value = 0;
    for (unsigned i = 0; i < bits; ++i)
        value |= uint64_t{(port[(at + i) / 32] >> ((at + i) % 32)) & 1U} << i;
    return value;
}

/// One clock edge of a verilated module.
template <typename Module>
void clock(Module& module) {
    module.clk = 0;
    module.eval();
    module.clk = 1;
    module.eval();
}

} // namespace hwsim::rtl
