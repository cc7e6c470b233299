#include "app/setup/device_file.h"

#include <fmt/format.h>

#include "app/setup/table_reader.h"
#include "app/setup/toml_file.h"

namespace app {
namespace {

void read_count(TableReader& table, const char* key, uint32_t& value) {
    const auto stated = table.integer(key);
    if (!stated) return;
    if (*stated < 1)
        table.refuse(key, "must be above 0");
    else
        value = static_cast<uint32_t>(*stated);
}

void read_within(TableReader& table, const char* key, double least, double most, double& value) {
    const auto stated = table.number(key);
    if (!stated) return;
    if (*stated < least || *stated > most)
        table.refuse(key, fmt::format("must be from {:g} to {:g}", least, most));
    else
        value = *stated;
}

void read_device(TableReader& table, hwsim::DeviceConfig& device) {
    read_count(table, "clock_mhz", device.clock_mhz);
    read_count(table, "elements", device.elements);
    read_count(table, "threads", device.threads);
    read_count(table, "stack_depth", device.stack_depth);
    read_count(table, "node_cache_lines", device.node_cache_lines);
    read_count(table, "record_cache_lines", device.record_cache_lines);
    read_count(table, "fifo_depth", device.fifo_depth);
    read_count(table, "memory_lines", device.memory_lines);
    read_count(table, "memory_latency", device.memory_latency);
    read_count(table, "cycles_per_line", device.cycles_per_line);
    read_count(table, "memory_queue", device.memory_queue);
    read_count(table, "write_queue", device.write_queue);
    read_count(table, "search_limit", device.search_limit);
    read_count(table, "memory_limit", device.memory_limit);
    table.finish();
}

void read_control(TableReader& table, ControlConfig& control) {
    read_within(table, "servo_period", 1e-5, 1.0, control.servo.period);
    read_within(table, "io_latency", 0.0, 10.0, control.servo.latency);
    read_within(table, "feed_override", 0.01, 10.0, control.servo.feed);
    read_count(table, "look_ahead", control.look_ahead);
    table.finish();
}

void read_energy(TableReader& table, EnergyTable& energy) {
    for (const auto& [key, value] : {std::pair{"box_test", &energy.box_test},
                                     {"pair_test", &energy.pair_test},
                                     {"cache_line", &energy.cache_line},
                                     {"memory_line", &energy.memory_line},
                                     {"idle_watts", &energy.idle_watts}})
        read_within(table, key, 0.0, 1e9, *value);
    table.finish();
}

core::Result<DeviceFile> device_file_in(const toml::table& parsed) {
    DeviceFile file;
    std::optional<core::Error> error;
    TableReader root(parsed, "device file", error);
    if (auto table = root.table("device", "[device]")) read_device(*table, file.device);
    if (auto table = root.table("control", "[control]")) read_control(*table, file.control);
    if (auto table = root.table("energy", "[energy]")) read_energy(*table, file.energy);
    root.finish();
    if (error) return tl::unexpected(*error);
    FEELER_TRY(file.device, hwsim::checked(file.device));
    return file;
}

} // namespace

core::Result<DeviceFile> read_device_file(const std::string& path) {
    FEELER_TRY(const toml::table parsed, read_toml(path));
    auto file = device_file_in(parsed);
    if (!file && file.error().file.empty()) file.error().file = path;
    return file;
}

} // namespace app
