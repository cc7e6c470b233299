#pragma once

#include <optional>
#include <vector>

#include "core/base/ids.h"
#include "core/motion/kinematics.h"
#include "core/motion/path.h"
#include "core/sim/block_result.h"
#include "core/sim/leg/check_memory.h"
#include "core/sim/moving_body.h"

namespace core {

class CutReplay;
struct CutModel;
struct Setup;

/// What the flutes do with material that they meet.
enum class FluteUse : uint8_t {
    cutting,
    not_cutting, // a collision; it is removed, so that there is one finding
    measured,    // a collision, and nothing is removed
    ignored      // they are not looked at, and nothing is removed
};

/// The position of a turning body is accurate enough if its error is at most this fraction of its
/// clearance.
constexpr double sharp_fraction = 0.02;

/// The pair of a moving body and a fixture; without `fixture`, the stock.
Pair pair_of(const MovingBody& body, std::optional<size_t> fixture = {});

/// Common data of the checks of a leg: the set-up, the tool with everything that moves with it, and
/// the memory of the run. Owns none of them.
struct LegContext {
    const Setup& setup;
    const ToolAssembly& tool;
    FluteUse use;
    BlockIndex block;
    const std::vector<bool>& mounted_fixtures;
    CheckMemory& memory;
    Statistics& statistics;
    std::vector<MovingBody> bodies;
    CutReplay* replay = nullptr; // makes the cuts of the stock; null: they are not prepared
    unsigned threads = 1;        // for a large cut
    /// The last leg of each body against the stock, which is asked for several times.
    mutable std::vector<std::pair<Leg, BodyLeg>> last_legs = {};
    /// How far each body gets against each link on the leg that was last asked for; negative if not
    /// computed yet.
    mutable std::pair<Leg, std::vector<double>> last_travels = {};

    CheckMemory::ToolState tool_state() const;

    /// The moving body of a pair.
    const MovingBody& body_of(const Pair& pair) const;

    /// The bodies in the order in which to check them against the stock or a fixture: the one that
    /// decided the last block comes first.
    std::vector<const MovingBody*> likely_first(std::optional<size_t> fixture) const;

    /// The leg of a body in the frame of a fixture, with the fixture's play.
    RelativeLeg against_fixture(const MovingBody& body, size_t fixture, const Leg& leg) const;

    /// How far any point of a body gets against a fixture, mm: the `travel` of against_fixture. All
    /// fixtures on one link share it, so it costs little.
    double travel_against_fixture(const MovingBody& body, size_t fixture, const Leg& leg) const;

    /// The leg of anything that is mounted in the stock's frame. The error of its path counts as
    /// one that lasts: shorter parts of a leg keep it.
    RelativeLeg against_stock(const Mover& mover, const Leg& leg) const;

    /// The leg of a body in the stock's frame. Valid until that of another leg is asked for.
    const BodyLeg& against_stock(const MovingBody& body, const Leg& leg) const;

    /// The parts of a shank or holder, which is shrunk by `shrink` first.
    const std::vector<TurningPart>& parts_of(const MovingBody& body, double shrink = 0.0) const;

    /// Whether a profile stays at least `by` away from the stock on a leg, as far as bounds show.
    bool stays_apart(const RevolvedProfile& profile, const RelativeLeg& leg, const CutModel& stock,
                     double by) const;

    /// Error of a turning body that is small enough for any clearance, mm; more if the error that
    /// stays is much greater.
    double finest_error(const MovingBody& body, const RelativeLeg& relative) const;

    /// Whether the error of a leg is small enough for a body with this lower bound.
    bool is_sharp(const MovingBody& body, const RelativeLeg& relative, double lower) const;
    bool is_sharp(const MovingBody& body, const BodyLeg& relative, double lower) const;

    /// Whether the error of a leg is too large for any clearance within the search limit.
    bool is_too_vague(const RelativeLeg& relative) const;
    bool is_too_vague(const BodyLeg& relative) const;

    /// Whether the flutes turn so far on a leg that they must cut or be checked in halves.
    bool flutes_turn_too_far(const Leg& leg) const;

    /// Whether one of the other parts of the tool turns so far that the leg must be halved.
    bool others_turn_too_far(const Leg& leg) const;
};

} // namespace core
