#pragma once

#include <map>

#include "app/coproc/device_answer.h"
#include "core/motion/kinematics.h"
#include "core/sim/moving_body.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
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

/// What the coprocessor said of a block: `report` is of a time when it had permitted all of it, or
/// had stopped.
BlockPermit answered(PushedBlock block, const hwsim::DeviceReport& report,
                     const core::Setup& setup);

/// How much is asked of a coprocessor: nothing behind the first refusal of a block, as a machine
/// would; or each question for itself, and how near the bodies come as well.
enum class Asking : uint8_t { until_refused, everything };

/// Asks a coprocessor for every motion of a program: each part of the tool and body of the machine
/// against the stock, as it is before each leg of the motion, and against each fixture. Refers to
/// the set-up.
///
/// What the flutes cut while they feed is no question, nor is where they have been before
/// (core::runs_in_own_cut), nor a body of the machine that stays farther than the search limit. A
/// motion on which something turns is divided until turning adds little. A way and a tool that are
/// not known cannot be asked. Whether a tool that does not cut at its centre is
/// pushed into the stock is for the host to say (core::follow).
class CoprocessorCheck {
public:
    /// Brings the stock into the device.
    ///
    /// Errors: those of the driver.
    static core::Result<CoprocessorCheck> with(hwsim::DevicePort port, const core::Setup& setup,
                                               const core::CutModel& stock,
                                               Asking asking = Asking::until_refused);

    /// Asks about a block, and waits for the answers.
    ///
    /// Errors: models that do not fit into the device.
    core::Result<BlockPermit> ask(std::span<const core::Event> block,
                                  const core::SimulatorState& before);

    /// The same without waiting: the device goes on with what was pushed before.
    core::Result<PushedBlock> push(std::span<const core::Event> block,
                                   const core::SimulatorState& before);
    /// What the device says now.
    hwsim::DeviceReport report() { return hwsim::report(driver_); }
    /// Clears a stop. What was pushed behind the segment that was refused is forgotten.
    void recover() { hwsim::recover(driver_); }

private:
    /// Where a block has got to.
    struct At {
        core::CutModel stock;
        std::vector<core::CutterSweep> to_cut; // from the stock, before anything more is asked
        const core::ToolAssembly* tool = nullptr;
        core::SpindleChange spindle;
        core::RoundedCorners corners;
        double off_motion = 0.0; // that corners take the motion, mm
        core::AxisPosition position;
        std::vector<bool> fixtures_there;
        core::CentreWatch centre;               // of a tool that does not cut there
        std::optional<core::ToolNumber> called; // tool in the spindle, described or not
        bool tool_known = false;
        bool is_cycle = false; // several motions
        bool follows = true;   // what its tool has cut, or leaves it upwards
    };
    /// A body of the tool's side over a leg, and what it must keep.
    struct Question {
        const core::MovingBody& body;
        core::Pair pair;
        core::RelativeLeg way;
        core::Allowance allowance;
        double off_path = 0.0; // that rounded corners may take the body, mm
        bool may_touch = false;
    };

    CoprocessorCheck(hwsim::Driver driver, const core::Setup& setup, Asking asking)
        : driver_(std::move(driver)), setup_(&setup), asking_(asking), models_(setup) {}

    core::Result<void> ask_event(const core::Event& event, At& at, PushedBlock& block);
    core::Result<void> ask_motion(const core::Motion& motion, At& at, PushedBlock& block);
    core::Result<void> ask_rest(At& at, PushedBlock& block);
    void hold(const std::optional<core::ToolNumber>& tool, At& at) const;
    bool pushes_centre(const core::Leg& leg, bool cutting, At& at) const;
    Question question(const core::MovingBody& body, std::optional<size_t> fixture,
                      const core::Leg& leg, const At& at) const;
    /// Whether a body of the machine stays so far away that nobody need ask.
    bool is_far(const Question& question, const core::ExactBody& other, PushedBlock& block) const;
    core::Result<void> bring_up_to_date(At& at);
    void note_cut(const core::Leg& leg, At& at) const;
    /// Asks along a leg; one on which something turns is halved until turning adds little.
    core::Result<void> walk(const core::Leg& leg, bool cutting, At& at, PushedBlock& block,
                            int depth = 0);
    /// Whether a body that turns may be too near for how vaguely its place is known.
    bool is_too_vague(const core::Leg& leg, const At& at) const;
    core::Result<void> ask_leg(const core::Leg& leg, bool cutting, At& at, PushedBlock& block);
    core::Result<void> ask_pair(const Question& question, hwsim::SlotNumber work,
                                PushedBlock& block);
    /// How near the bodies come, if everything is asked.
    core::Result<void> measure_pair(const Question& question, hwsim::SlotNumber work,
                                    PushedBlock& block);
    /// Waits for the answers, and takes them in; why the device stopped, if it did.
    hwsim::Stop take_answers(PushedBlock& block);
    bool is_in_own_cut(const Question& question, const At& at) const;

    hwsim::Driver driver_;
    const core::Setup* setup_;
    Asking asking_;
    hwsim::SlotNumber stock_{};
    DeviceModels models_;
};

} // namespace app
