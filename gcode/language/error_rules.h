#pragma once

#include <string_view>

#include "core/base/result.h"

namespace gcode {

// Codes of errors that break a rule of their own, beside the common ones of core/base.
constexpr core::ErrorCode wrong_arc{64};
constexpr core::ErrorCode no_feed{65};

/// The stable name of the rule that an error of the interpreter is about; empty when it has none.
constexpr std::string_view rule_of(const core::Error& error) {
    return error.code == wrong_arc ? "arc-radius" : error.code == no_feed ? "no-feed" : "";
}

} // namespace gcode
