#include "app/coproc/permit_timing.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/setup/table_reader.h"
#include "app/setup/toml_file.h"

namespace app {
namespace {

class TimedRun {
public:
    TimedRun(const std::vector<core::PermitMotion>& plan, const std::vector<BlockService>& services,
             const ControlConfig& control, bool past_refusals)
        : services_(services),
          control_(control),
          past_refusals_(past_refusals),
          machine_(core::permit_run(plan, control.servo)) {
        made_.blocks.resize(services.size());
        made_.planned = machine_.times.back() / control.servo.feed;
    }

    PermitTiming run() {
        while (!machine_.is_done() && !is_stopped_for_good()) {
            ask_ahead();
            permit();
            core::step(machine_, permitted_);
        }
        made_.taken = machine_.time();
        if (machine_.is_done()) ask_for_the_rest();
        conclude();
        return std::move(made_);
    }

private:
    bool is_refused(size_t block) const { return !past_refusals_ && services_[block].refused; }
    bool is_stopped_for_good() const {
        return machine_.is_held() && permitted_ < asked_ && is_refused(permitted_)
               && made_.blocks[permitted_].permitted <= machine_.time();
    }

    /// Lets the control read ahead, and the device accept the new blocks.
    void ask_ahead() {
        const size_t here =
            machine_.is_done() ? services_.size() : machine_.motions[machine_.motion].segment;
        const size_t end = std::min(services_.size(), here + control_.look_ahead + 1);
        for (; asked_ < end; ++asked_) {
            BlockTiming& block = made_.blocks[asked_];
            const BlockService& service = services_[asked_];
            block.permitted = queue_.next(service, machine_.time());
            block.asked = queue_.requested();
            made_.busy += service.interval;
            made_.making += service.making;
            if (is_refused(asked_)) queue_.stop();
        }
    }

    /// Blocks without motion do not hold the machine, but may be refused.
    void ask_for_the_rest() {
        ask_ahead();
        while (permitted_ < asked_ && !is_refused(permitted_)) ++permitted_;
    }

    void permit() {
        while (permitted_ < asked_ && !is_refused(permitted_)
               && made_.blocks[permitted_].permitted <= machine_.time())
            ++permitted_;
    }

    void conclude() {
        if (permitted_ < services_.size()) made_.refused = permitted_;
        for (size_t i = machine_.motions.size();
             i-- > 0;) { // backwards: the first motion of a block wins
            BlockTiming& block = made_.blocks[machine_.motions[i].segment];
            block.due = machine_.entries[i].due;
            block.entered = machine_.entries[i].entered;
        }
        for (size_t i = 0; i < made_.blocks.size(); ++i) {
            const BlockTiming& block = made_.blocks[i];
            if (block.due == core::infinity || block.permitted == core::infinity) continue;
            made_.missed += block.is_late();
            if (!made_.tightest || block.slack() < made_.blocks[*made_.tightest].slack())
                made_.tightest = i;
        }
    }

    const std::vector<BlockService>& services_;
    const ControlConfig& control_;
    bool past_refusals_;
    core::PermitRun machine_;
    PermitTiming made_;
    size_t asked_ = 0;
    uint32_t permitted_ = 0;
    PermitQueue queue_;
};

} // namespace

PermitTiming timed_with_permits(const std::vector<core::PermitMotion>& plan,
                                const std::vector<BlockService>& services,
                                const ControlConfig& control, bool past_refusals) {
    return TimedRun(plan, services, control, past_refusals).run();
}

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
    const auto stated = table.number(key, Measure::plain);
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
    if (const auto volumes = table.word("volumes", {"boxes", "spheres"}))
        device.volumes = *volumes == "spheres" ? hwsim::Volumes::spheres : hwsim::Volumes::boxes;
    read_count(table, "stack_depth", device.stack_depth);
    read_count(table, "node_cache_lines", device.node_cache_lines);
    read_count(table, "record_cache_lines", device.record_cache_lines);
    read_count(table, "fifo_depth", device.fifo_depth);
    read_count(table, "memory_lines", device.memory_lines);
    read_count(table, "memory_latency", device.memory_latency);
    read_count(table, "cycles_per_line", device.cycles_per_line);
    read_count(table, "memory_queue", device.memory_queue);
    read_count(table, "write_queue", device.write_queue);
    read_count(table, "host_latency", device.host_latency);
    read_count(table, "host_cycles_per_line", device.host_cycles_per_line);
    read_count(table, "host_queue", device.host_queue);
    read_count(table, "search_limit", device.search_limit);
    read_count(table, "memory_limit", device.memory_limit);
    table.finish();
}

void read_control(TableReader& table, ControlConfig& control) {
    read_within(table, "servo_period", 1e-5, 1.0, control.servo.period);
    read_within(table, "io_latency", 0.0, 10.0, control.servo.latency);
    read_within(table, "feed_override", 0.01, 10.0, control.servo.feed);
    read_count(table, "look_ahead", control.look_ahead);
    constexpr double micro = 1e-6;
    double line_time = control.line_time / micro;
    read_within(table, "line_time_us", 0.0, 1000.0, line_time);
    control.line_time = line_time * micro;
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
