#pragma once

namespace app {

struct StatedControl;
class TableReader;

/// Reads `control = "NAME"` or the table `[control]` of a file; keys that are not there stay.
void read_control(TableReader& root, StatedControl& control);

} // namespace app
