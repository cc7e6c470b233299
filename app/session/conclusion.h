#pragma once

#include "app/session/length_doubt.h"
#include "app/session/prepared_check.h"

namespace app {

/// What can be said only of a whole run, once its last block was carried out: findings in their
/// order, those that one cause explains made one, comments that allow rules, the part, the stock
/// that is left.
void conclude(PreparedCheck& check, core::SimulatorState end,
              const std::vector<LengthDoubt>& doubts, bool needs_surface);

} // namespace app
