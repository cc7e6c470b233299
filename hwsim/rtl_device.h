#pragma once

#include <functional>
#include <memory>

#include "hwsim/driver.h"
#include "hwsim/memory_unit.h"
#include "hwsim/registers.h"

namespace hwsim {

/// The circuit in rtl/, translated to C++ by Verilator, with models of the two memories that it is
/// connected to. At each clock edge it does what the emulator does.
class RtlDevice {
public:
    /// Errors:  those of checked(); no circuit of these sizes was translated.
    static core::Result<RtlDevice> with(const DeviceConfig& config);
    RtlDevice(RtlDevice&&) noexcept;
    RtlDevice& operator=(RtlDevice&&) noexcept;
    ~RtlDevice();

    const DeviceConfig& config() const;
    DeviceMemory& memory();
    HostMemory& shared();
    /// Uses these memories in place of its own; they must outlive the device.
    void share(DeviceMemory& memory, HostMemory& host);
    /// No answers from the memory, or from that of the host: injected faults.
    void set_stalled(bool memory, bool host);

    /// One rising clock edge. A reset, which takes an edge of its own, is not counted.
    void clock();
    uint64_t cycle() const;

    /// A read or write on the register bus at the coming edge; `address` in bytes. One at an edge.
    uint32_t read(uint32_t address);
    void write(uint32_t address, uint32_t value);
    bool interrupt();

    uint32_t bus_cycles = 4; // of each register access, and each wait, of its port

private:
    struct Board;
    explicit RtlDevice(std::unique_ptr<Board> board);

    std::unique_ptr<Board> board_;
};

/// The device must outlive the port and must not move. `after_cycle` is called after each cycle.
DevicePort port_of(RtlDevice& device, std::function<void()> after_cycle = {});

} // namespace hwsim
