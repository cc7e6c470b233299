#pragma once

#include <map>

#include "app/coproc/device_answer.h"
#include "core/motion/kinematics.h"
#include "core/sim/moving_body.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "hwsim/body_cover.h"
#include "hwsim/driver.h"

namespace core {
struct CornerPlan;
}

namespace app {

/// The bodies of a set-up as models in a device. Each is loaded when first needed. Refers to the
/// set-up.
class DeviceModels {
public:
    explicit DeviceModels(const core::Setup& setup)
        : setup_(&setup), fixtures_(setup.fixtures.size()) {}

    /// Loads a body on the tool side, shrunk and in its orientation. A model with another
    /// orientation replaces the previous one.
    ///
    /// Errors: models that do not fit into the device.
    core::Result<hwsim::SlotNumber> of_body(hwsim::Driver& driver, const core::MovingBody& body,
                                            double shrink, const core::Mat3& orientation);
    core::Result<hwsim::SlotNumber> of_fixture(hwsim::Driver& driver, size_t fixture);

    /// Unloads the parts of any other tool.
    void use_tool(hwsim::Driver& driver, const core::ToolAssembly* tool);

    /// Upper bound, except for rounding, of how far the model of a body in this orientation extends
    /// beyond the body, mm.
    double excess(const core::MovingBody& body, const core::Mat3& orientation) const;

private:
    /// The kind of a body, its index among the machine bodies, and the amount by which it is
    /// shrunk.
    using Key = std::tuple<core::PartKind, size_t, double>;
    struct Loaded {
        hwsim::SlotNumber slot{};
        core::Mat3 orientation = core::Mat3(1.0);
    };

    core::Result<std::vector<hwsim::Record>> records_of(const core::MovingBody& body, double shrink,
                                                        const core::Mat3& orientation);

    const core::Setup* setup_;
    std::vector<std::optional<hwsim::SlotNumber>> fixtures_;
    const core::ToolAssembly* tool_ = nullptr; // the tool whose parts are loaded
    std::map<Key, Loaded> bodies_;
    std::map<size_t, hwsim::CubeCover> cubes_; // of machine bodies that have been tilted
};

/// The answer for a block. `report` must date from when the device had permitted the whole block or
/// had stopped.
BlockPermit answered(PushedBlock block, const hwsim::DeviceReport& report,
                     const core::Setup& setup);

/// How many questions are asked of a coprocessor: those up to the first refusal of a block, as on a
/// machine; or all of them one by one, with clearances.
enum class QueryScope : uint8_t { until_refused, everything };

/// Asks a coprocessor about every motion of a program: each part of the tool and each machine body
/// against the stock, as it is before each leg of the motion, and against each fixture. Refers to
/// the set-up.
///
/// Not asked: what the flutes cut on feeds, flutes in their own cut (core::runs_in_own_cut), and
/// machine bodies farther away than the search limit. A motion with rotation is divided until the
/// rotation adds little error. Unknown paths and tools cannot be asked about. Whether the uncut
/// centre of a tool is pushed into the stock is checked by the host (core::follow).
class CoprocessorCheck {
public:
    /// Loads the stock into the device.
    ///
    /// Errors: those of the driver.
    static core::Result<CoprocessorCheck> with(hwsim::DevicePort port, const core::Setup& setup,
                                               const core::CutModel& stock,
                                               QueryScope asking = QueryScope::until_refused);

    /// Asks about a block and waits for the answers. `doubt`: why nothing can be proven about it,
    /// or empty.
    ///
    /// Errors: models that do not fit into the device.
    core::Result<BlockPermit> ask(std::span<const core::Event> block,
                                  const core::SimulatorState& before, const std::string& doubt);

    /// As ask, without waiting: the device continues with earlier blocks.
    core::Result<PushedBlock> push(std::span<const core::Event> block,
                                   const core::SimulatorState& before, const std::string& doubt);
    /// The current report of the device.
    hwsim::DeviceReport report() { return hwsim::report(driver_); }

    /// Lines that the host has made so far: descriptors, and lines of models.
    uint64_t lines_made() const { return driver_.lines_made; }
    /// Clears a stop. Questions pushed after the refused segment are discarded.
    void recover() { hwsim::recover(driver_); }

private:
    /// State within a block.
    struct At {
        core::CutModel stock;
        std::vector<core::CutterSweep> to_cut; // to be cut from the stock before the next question
        const core::ToolAssembly* tool = nullptr;
        core::SpindleChange spindle;
        core::RoundedCorners corners;
        double off_motion = 0.0; // deviation of the motion by rounded corners, mm
        core::AxisPosition position;
        core::AxisSet uncertain = 0; // axes that a probing move may have stopped anywhere
        std::vector<bool> mounted_fixtures;
        core::CentreTracker centre;             // for a tool that does not cut at its centre
        std::optional<core::ToolNumber> called; // tool in the spindle, described or not
        bool tool_known = false;
        std::array<bool, 3> is_assumed{}; // X, Y, Z: not moved yet from an assumed start
        bool is_cycle = false;            // the block has several motions
        /// How the motion follows the tool's own cut, or leaves it upwards.
        struct Follows {
            bool flutes = false;
            std::optional<size_t> first_cut; // that made room for other parts, see first_own_cut
        } follows;
        bool at_corner = false; // legs of a corner are asked about; they cut nothing
    };
    /// A body on the tool side over a leg, and its minimum clearance.
    struct Question {
        const core::MovingBody& body;
        core::Pair pair;
        core::RelativeLeg way;
        core::Allowance allowance;
        double off_path = 0.0; // deviation of the body by rounded corners, mm
        bool may_touch = false;
    };

    CoprocessorCheck(hwsim::Driver driver, const core::Setup& setup, QueryScope asking)
        : driver_(std::move(driver)), setup_(&setup), asking_(asking), models_(setup) {}

    core::Result<void> query_event(const core::Event& event, At& at, PushedBlock& block);
    core::Result<void> query_motion(const core::Motion& motion, At& at, PushedBlock& block);
    /// Asks about the corner where a motion begins, if the control may round it.
    core::Result<void> query_corner(const core::CornerPlan& plan, bool between_feeds, At& at,
                                    PushedBlock& block);
    /// With an unknown tool, which otherwise counts as none: asks along legs with each that it may
    /// be.
    core::Result<void> query_each_tool(const std::vector<core::Leg>& legs, At& at,
                                       PushedBlock& block);
    core::Result<void> query_standstill(At& at, PushedBlock& block);
    void hold(const std::optional<core::ToolNumber>& tool, At& at) const;
    bool pushes_centre(const core::Leg& leg, bool cutting, At& at) const;
    Question question(const core::MovingBody& body, std::optional<size_t> fixture,
                      const core::Leg& leg, const At& at) const;
    /// Whether, at a corner, boxes show that a body keeps its distance, so that no question is
    /// needed: there are many at a corner.
    static bool is_clear_at_corner(const Question& question, const core::Aabb& other, const At& at);
    /// Whether a machine body stays so far away that no question is needed.
    bool is_far(const Question& question, const core::ExactBody& other, PushedBlock& block) const;
    core::Result<void> update_models(At& at);
    void note_cut(const core::Leg& leg, At& at) const;
    /// Asks along a leg. A leg with rotation is halved until the rotation adds little error.
    core::Result<void> walk(const core::Leg& leg, bool cutting, At& at, PushedBlock& block,
                            int depth = 0);
    /// Whether a rotating body may be too close, given the uncertainty of its position.
    bool is_too_vague(const core::Leg& leg, const At& at) const;
    core::Result<void> query_leg(const core::Leg& leg, bool cutting, At& at, PushedBlock& block);
    core::Result<void> query_pair(const Question& question, hwsim::SlotNumber work,
                                  PushedBlock& block);
    /// Measures the clearance of the bodies, if everything is asked.
    core::Result<void> measure_pair(const Question& question, hwsim::SlotNumber work,
                                    PushedBlock& block);
    /// Waits for the answers and stores them. Returns why the device stopped, if it did.
    hwsim::Stop collect_answers(PushedBlock& block);
    bool is_in_own_cut(const Question& question, const At& at) const;

    hwsim::Driver driver_;
    const core::Setup* setup_;
    QueryScope asking_;
    hwsim::SlotNumber stock_{};
    DeviceModels models_;
};

} // namespace app
