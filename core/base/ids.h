#pragma once

#include <cstdint>
#include <type_traits>

namespace core {

/// Counts the blocks of a run in the order in which they are executed, from 0.
enum class BlockIndex : uint32_t {};

/// The number by which a program calls a tool (T). Not a pocket and not an index.
enum class ToolNumber : int32_t {};

/// The number of an entry in the control's tool offset table (H, D).
enum class OffsetNumber : int32_t {};

template <typename Id>
constexpr auto value_of(Id id) {
    return static_cast<std::underlying_type_t<Id>>(id);
}

} // namespace core
