#include "app/commands/device_arguments.h"

namespace app {

void add_device_arguments(CLI::App& command, viewer::DeviceChoice& device) {
    command.add_flag("--coprocessor", device.shown,
                     "Run the program beside an emulated coprocessor, and show its panel");
    command
        .add_option("--device", device.file,
                    "The same beside this one: device file (TOML), as coproc --config has it")
        ->each([&device](const std::string&) { device.shown = true; });
}

} // namespace app
