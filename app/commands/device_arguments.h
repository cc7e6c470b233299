#pragma once

#include <CLI/CLI.hpp>

#include "app/view/ui/window.h"

namespace app {

/// Gives a command the options that say beside which coprocessor a program is run. The choice must
/// outlive it.
void add_device_arguments(CLI::App& command, viewer::DeviceChoice& device);

} // namespace app
