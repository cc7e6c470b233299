#include "tests/gcode/checkpoints.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/contour/contour.h"
#include "gcode/contour/spline.h"
#include "gcode/klartext/klartext_state.h"
#include "gcode/siemens/siemens_state.h"

namespace gcode {
namespace {

constexpr size_t free_memory = size_t(1) << 20; // before intervals grow
constexpr size_t bytes_of_map_node = 96;

size_t memory_of(const Parameters& parameters) {
    return parameters.numbered_count() * sizeof(Value)
           + parameters.named().size() * bytes_of_map_node;
}

size_t memory_of(const Tables& tables) {
    return sizeof(Tables) + tables.work.size() * sizeof(WorkOffset)
           + tables.lengths.size() * (sizeof(LengthOffset) + bytes_of_map_node)
           + (tables.tool_lengths.size() + tables.tool_diameters.size()) * bytes_of_map_node;
}

size_t memory_of(const Frame& frame) {
    return sizeof(Frame) + (frame.named.size() + frame.repeats.size()) * bytes_of_map_node
           + sizeof(ModalState);
}

size_t memory_of(const BlockCommands& block) {
    return sizeof(BlockCommands) + block.commands.size() * sizeof(CanonicalCommand)
           + block.columns.size() * sizeof(uint32_t)
           + (block.own_text ? block.own_text->size() : 0);
}

/// Memory of a state in addition to what it shares with the previous one.
size_t memory_of(const InterpreterState& state, const InterpreterState* before) {
    size_t bytes = sizeof(InterpreterState) + state.modal_macros.size() * sizeof(ModalMacro);
    for (const Frame& frame : state.frames) bytes += memory_of(frame);
    for (const PendingBlock& block : state.contour->pending)
        bytes += memory_of(block.result) + block.slots.size() * sizeof(PendingBlock::Slot);
    for (const BlockCommands& block : state.contour->ready) bytes += memory_of(block);
    if (!before || &*state.parameters != &*before->parameters)
        bytes += memory_of(*state.parameters);
    if (!before || &*state.tables != &*before->tables) bytes += memory_of(*state.tables);
    if (!before || state.language.get() != before->language.get()) bytes += sizeof(KlartextState);
    return bytes;
}

} // namespace

void Checkpoints::add(const InterpreterState& state) {
    memory_ += memory_of(state, states_.empty() ? nullptr : &states_.back());
    states_.push_back(state);
}

void Checkpoints::thin_out() {
    std::vector<InterpreterState> all = std::move(states_);
    states_.clear();
    memory_ = 0;
    interval_ *= 2;
    for (size_t i = 0; i < all.size(); i += 2) add(all[i]);
}

void Checkpoints::note(uint64_t results, const InterpreterState& state) {
    if (results % interval_ != 0 || results / interval_ != states_.size()) return;
    add(state);
    while (states_.size() > 1 && memory_ > std::max(free_memory, results * bytes_per_block_))
        thin_out();
}

core::Result<InterpreterState> Checkpoints::state_after(uint64_t results,
                                                        Interpreter& interpreter) const {
    const auto too_far = [&] {
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("the run has no block {}", results));
    };
    if (states_.empty()) return too_far();
    const uint64_t nearest = std::min<uint64_t>(results / interval_, states_.size() - 1);
    InterpreterState state = states_[nearest];
    for (uint64_t at = nearest * interval_; at < results; ++at) {
        FEELER_TRY(const BlockCommands* block, interpreter.next(state));
        if (!block) return too_far();
    }
    return state;
}

} // namespace gcode
