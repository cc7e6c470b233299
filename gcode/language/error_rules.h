#pragma once

#include <string_view>

#include "core/base/result.h"
#include "core/base/rule_table.h"

namespace gcode {

// Error codes with a rule of their own, in addition to the common ones of core/base.
constexpr core::ErrorCode wrong_arc{64};
constexpr core::ErrorCode no_feed{65};
constexpr core::ErrorCode program_alarm{66}; // #3000, FN 14

/// The stable rule name of an interpreter error; empty if it has none.
constexpr std::string_view rule_of(const core::Error& error) {
    return error.code == wrong_arc ? core::rule_id("arc-radius")
           : error.code == no_feed ? core::rule_id("no-feed")
                                   : "";
}

} // namespace gcode
