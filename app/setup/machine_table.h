#pragma once

#include "app/setup/body_table.h"
#include "app/setup/table_reader.h"

namespace app {

/// Reads `[machine]`, or a machine file. What the table does not say stays as it was.
void read_machine(TableReader& table, core::Machine& machine, const MeshSource& source);

} // namespace app
