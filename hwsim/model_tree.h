#pragma once

#include <span>
#include <vector>

#include "core/base/result.h"
#include "hwsim/line_space.h"

namespace hwsim {

/// A tree or a part of one, and what holds it. The volume of none says nothing.
struct Branch {
    Reference reference;
    Volume volume;

    bool operator==(const Branch&) const = default;
};

/// A line and where it belongs.
struct AddressedLine {
    uint32_t address = 0;
    Line line;
};

/// Lines that are being made for the device: what is to be written, and the room it takes.
struct ModelWriter {
    LineSpace* space = nullptr;
    Side side = Side::work;
    uint32_t epoch = 0; // of all lines made
    std::vector<AddressedLine> lines;
    std::vector<LineRun> runs; // taken from the space, in order

    /// Errors: the memory is full.
    core::Result<uint32_t> add(const Node& node);
    core::Result<Branch> add_leaf(std::span<const Record> records); // 1 to 32
};

/// A tree over records, split at the median along the longest side of the box of their places until
/// no more than `leaf_size` are left. Same records, same tree.
///
/// Errors: no records; a record that reaches beyond the range of coordinates; a leaf size that is
///         not 1 to 32; the memory is full.
core::Result<Branch> add_tree(ModelWriter& writer, std::vector<Record> records, uint32_t leaf_size);

/// The node above two branches, either of which may be none; the other one itself if one is.
core::Result<Branch> add_above(ModelWriter& writer, const Branch& a, const Branch& b);

/// The header line of a model: what a slot of the device holds.
core::Result<uint32_t> add_header(ModelWriter& writer, const Branch& root);

} // namespace hwsim
