#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/tolerance/deviation.h"
#include "app/tolerance/limit_search.h"
#include "app/tolerance/recorded_motions.h"
#include "core/sim/setup.h"

namespace core {
struct Leg;
struct SimulatorState;
} // namespace core

namespace app {

struct PreparedCheck;

/// A range of deviations, mm; it contains 0 or, for a diameter, may lie on either side of it.
struct DeviationRange {
    double least = 0.0, most = 0.0;

    double reach() const { return std::max(std::abs(least), std::abs(most)); }
};

/// Shows that a program stays clear for all deviations of a range, by simulating sets that contain
/// every body at every deviation, and cuts that take place at every deviation
/// (docs/decisions/tolerances.md). All arguments must outlive it.
class Enclosure {
public:
    /// `base`: the set-up without deviation; `shifts`: how the deviation displaces the motions;
    /// `may_go_on`: told by simulations from time to time what they have done since the last call,
    /// in tests; false: they end, and show nothing.
    Enclosure(const PreparedCheck& check, const core::Setup& base, const RecordedMotions& motions,
              const Shifts& shifts, const Deviation& deviation,
              std::function<bool(size_t)> may_go_on);

    /// Whether the program is clear for all deviations of the range: empty if it is.
    std::optional<LimitingPair> first_limit(const DeviationRange& range) const;

    /// Why nothing can be shown; empty if something can.
    const std::string& obstacle() const { return obstacle_; }

private:
    /// The displacement of the spindle against everything else, per mm of deviation.
    struct Displacement {
        std::vector<core::Vec3> targets; // against the stock, then each fixture; in their links
        std::vector<core::Vec3> bodies;  // of each machine body against the spindle; in its link
        double reach = 0.0;              // no displacement is longer, however rotary axes turn
        core::AxisValues axes{};
    };

    /// The state of one simulation.
    struct Run;

    Displacement displacement(const core::AxisValues& values, const core::AxisValues& by) const;
    uint16_t frame_of(const core::AxisPosition& position, uint16_t kind);
    void find_frames();
    bool is_cutting(const core::Motion& motion, const Run& run) const;

    core::Setup in_frame(uint16_t frame, const DeviationRange& range) const;
    core::Setup with_doubt(const core::Setup& setup, double doubt) const;
    double doubt_of(size_t event, uint16_t frame, const DeviationRange& range) const;
    std::optional<LimitingPair> simulate(uint16_t frame, const DeviationRange& range) const;
    std::optional<LimitingPair> judge_all(Run& run) const;
    std::optional<LimitingPair> judge(Run& run, size_t event) const;
    std::optional<LimitingPair> judge_hull(Run& run, size_t event,
                                           const core::Motion& motion) const;
    /// Whether all bodies stay clear along legs from which the tool may deviate by `off_path`.
    /// `cuts`: the flutes may cut the stock there.
    std::optional<LimitingPair> judge_legs(Run& run, size_t event,
                                           const std::vector<core::Leg>& legs, double off_path,
                                           bool cuts) const;
    /// Judges the part that the simulator leaves out at the start of a motion if a control rounds
    /// the corner there: that of the exact one of two motions of which the other is not exact.
    std::optional<LimitingPair> judge_corner(Run& run, size_t event,
                                             const core::Motion& motion) const;
    bool has_hull(size_t event, const core::Motion& motion, uint16_t frame) const;
    bool is_exact(size_t event, uint16_t frame) const;
    bool is_judged_in(size_t event, uint16_t frame, bool first) const;

    const PreparedCheck& check_;
    const core::Setup& base_;
    const RecordedMotions& motions_;
    const Shifts& shifts_;
    const Deviation& deviation_;
    std::function<bool(size_t)> may_go_on_;
    std::vector<Displacement> frames_;   // frame 0: none
    std::vector<Shifts::Ends> frame_of_; // of each event
    std::vector<bool> turns_;            // of each event: rotary axes move
    std::vector<uint16_t> simulated_;    // frames in which something is cut
    std::string obstacle_;
};

} // namespace app
