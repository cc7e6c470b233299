#pragma once

#include "app/setup/setup_file.h"
#include "app/setup/table_reader.h"

namespace app {

/// Reads `[machine]`, or a machine file, into the set-up.
void read_machine(TableReader& table, core::Machine& machine);

} // namespace app
