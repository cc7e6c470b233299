#pragma once

#include "gcode/text/digest.h"

namespace gcode {

struct Frame;

template <typename T>
uint64_t number_of(T value) {
    return static_cast<uint64_t>(static_cast<int64_t>(value));
}

template <typename Values>
void add_all(Digest& digest, const Values& values) {
    for (const auto& value : values) digest.add(value);
}

void add(Digest& digest, const Frame& frame);

} // namespace gcode
