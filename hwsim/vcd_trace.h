#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hwsim {

struct CoprocessorState;
struct DeviceConfig;

/// The signals of a device over time, as a value change dump (IEEE 1364) for GTKWave.
///
/// Units:   picoseconds; one device cycle is one clock period.
class VcdTrace {
public:
    explicit VcdTrace(const DeviceConfig& config);

    /// Records the device after a cycle. Between two recorded cycles nothing changes in the dump.
    void note(const CoprocessorState& state);

    /// The whole file.
    const std::string& text() const { return text_; }

private:
    struct Signal {
        std::string id;
        uint32_t bits = 1;
        uint64_t value = ~uint64_t{0}; // the last value written
    };
    void declare(const std::string& name, uint32_t bits);
    void write(size_t signal, uint64_t value, bool& has_time, uint64_t cycle);

    uint64_t clock_mhz_;
    std::vector<Signal> signals_;
    std::string text_;
};

} // namespace hwsim
