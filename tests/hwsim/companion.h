#pragma once

#include <functional>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "hwsim/coprocessor.h"
#include "hwsim/driver.h"

namespace hwsim {

/// A device that does whatever an emulated one does, with the same memories, and is held against
/// it.
class Companion {
public:
    virtual ~Companion() = default;
    /// The edge that the emulated device has just had.
    virtual void clock(CoprocessorState& emulated) = 0;
    virtual void write(uint32_t address, uint32_t value) = 0;
    virtual uint32_t read(uint32_t address) = 0;
};

/// Makes a companion for a device, or null. Without circuits there are none.
inline std::unique_ptr<Companion> (*make_companion)(const DeviceConfig&) = nullptr;

/// The companion of a device, if there is one. A copy of the device has none.
class MaybeCompanion {
public:
    explicit MaybeCompanion(const DeviceConfig& config)
        : companion_(make_companion ? make_companion(config) : nullptr) {}
    MaybeCompanion(const MaybeCompanion&) {}
    MaybeCompanion(MaybeCompanion&&) = default;
    MaybeCompanion& operator=(const MaybeCompanion&) {
        companion_ = nullptr;
        return *this;
    }
    MaybeCompanion& operator=(MaybeCompanion&&) = default;
    ~MaybeCompanion() = default;

    void clock(CoprocessorState& emulated) const {
        if (companion_) companion_->clock(emulated);
    }
    void write(uint32_t address, uint32_t value) const {
        if (companion_) companion_->write(address, value);
    }
    void expect(uint32_t address, uint32_t value) const {
        if (companion_) {
            EXPECT_EQ(companion_->read(address), value) << std::hex << address;
        }
    }
    void leave() { companion_ = nullptr; }

private:
    std::unique_ptr<Companion> companion_;
};

/// The port to an emulated device. Its companion, if any, gets the same, and everything that is
/// read is compared. `after_cycle` may change the memories.
inline DevicePort
port_with_companion(EmulatedDevice& device,
                    const std::function<void(const CoprocessorState&)>& after_cycle = {}) {
    const auto companion = std::make_shared<MaybeCompanion>(device.config);
    DevicePort port = port_of(device, [&device, companion, after_cycle](const CoprocessorState& s) {
        companion->clock(device.state);
        if (after_cycle) after_cycle(s);
    });
    port.read = [companion, read = std::move(port.read)](Register r) {
        const uint32_t value = read(r);
        companion->expect(address_of(r), value);
        return value;
    };
    port.write = [companion, write = std::move(port.write)](uint32_t address, uint32_t value) {
        write(address, value);
        companion->write(address, value);
    };
    return port;
}

} // namespace hwsim
