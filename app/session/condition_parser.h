#pragma once

#include <string_view>

#include "app/session/condition_node.h"

namespace app {

/// What a text in the language of conditions means, of whatever type.
///
/// Errors: syntax, with the column.
core::Result<Condition::Node> parse_condition(std::string_view text);

} // namespace app
