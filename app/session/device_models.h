#pragma once

#include <map>

#include "core/sim/moving_body.h"
#include "hwsim/body_cover.h"
#include "hwsim/driver.h"

namespace app {

/// The bodies of a set-up as models in a device: each is brought in when it is asked for. Refers to
/// the set-up.
class DeviceModels {
public:
    explicit DeviceModels(const core::Setup& setup)
        : setup_(&setup), fixtures_(setup.fixtures.size()) {}

    /// A body of the tool's side, shrunk, as it is held. One that is held in another way than the
    /// last time takes its place.
    ///
    /// Errors: models that do not fit into the device.
    core::Result<hwsim::SlotNumber> of_body(hwsim::Driver& driver, const core::MovingBody& body,
                                            double shrink, const core::Mat3& orientation);
    core::Result<hwsim::SlotNumber> of_fixture(hwsim::Driver& driver, size_t fixture);

    /// Takes the parts of any other tool out of the device.
    void use_tool(hwsim::Driver& driver, const core::ToolAssembly* tool);

    /// How far the model of a body that is held so stands out of it at most, mm, but for rounding.
    double excess(const core::MovingBody& body, const core::Mat3& orientation) const;

private:
    /// A body's kind, which of the machine's it is, and by how much it is shrunk.
    using Key = std::tuple<core::PartKind, size_t, double>;
    struct Loaded {
        hwsim::SlotNumber slot{};
        core::Mat3 orientation = core::Mat3(1.0);
    };

    core::Result<std::vector<hwsim::Record>> records_of(const core::MovingBody& body, double shrink,
                                                        const core::Mat3& orientation);

    const core::Setup* setup_;
    std::vector<std::optional<hwsim::SlotNumber>> fixtures_;
    const core::ToolAssembly* tool_ = nullptr; // whose parts are in the device
    std::map<Key, Loaded> bodies_;
    std::map<size_t, hwsim::CubeCover> cubes_; // of the machine's bodies that have been at an angle
};

} // namespace app
