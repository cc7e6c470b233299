#include "hwsim/segment.h"

#include <array>

namespace hwsim {

const char* name_of(Stop stop) {
    static constexpr std::array<const char*, stop_count> names = {
        "none",          "violation",      "out-of-range", "sequence",      "fifo-overrun",
        "model-missing", "model-changed",  "bad-check",    "bad-address",   "stack-overflow",
        "too-long",      "memory-stalled", "host-silent",  "bad-descriptor"};
    return names[static_cast<size_t>(stop)];
}

} // namespace hwsim
