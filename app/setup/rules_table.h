#pragma once

#include "app/setup/table_reader.h"
#include "core/sim/finding.h"

namespace app {

/// The severities that a table `[rules]` gives to rules by name; the key `but`, if any, is left to
/// the caller. A name that is no rule is refused with the nearest that is one.
core::RuleSeverities read_severities(TableReader& table, const std::string& but = {});

} // namespace app
