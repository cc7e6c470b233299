#pragma once

#include <span>

#include "app/session/inspected_value.h"

namespace app {

enum class ModalKind : uint8_t { number, word };

/// A modal value by its name.
struct ModalEntry {
    std::string_view name;
    ModalKind kind;
    std::string_view words; // all that a word may be, with commas; empty: too many to list
    InspectedValue (*read)(const gcode::InterpreterState& control, const gcode::Dialect& dialect);
};

/// All of them, in the order in which a person asks.
std::span<const ModalEntry> modal_table();

/// The entry of that name; null when there is none.
const ModalEntry* modal_entry(std::string_view name);

/// The words that an entry's value may be.
std::vector<std::string> words_of(const ModalEntry& entry);

/// "G54", "G59.1", "G54.1P3", "G500".
std::string offset_name(size_t index);

/// The index of that name, in capitals; empty when it names none.
std::optional<size_t> offset_named(std::string_view name);

} // namespace app
