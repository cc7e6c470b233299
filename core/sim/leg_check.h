#pragma once

#include "core/dbm/cut_model.h"
#include "core/distance/stock_distance.h"
#include "core/sim/clearance.h"
#include "core/sim/path.h"
#include "core/sim/statistics.h"

namespace core {

/// Where each part of a tool last met the stock most nearly: a good place to look first.
using StockHints = std::array<std::optional<LineId>, 3>;

/// Whether what the flutes meet becomes chips or is a crash.
enum class FluteUse : uint8_t { cutting, not_cutting };

/// Checks a tool along the legs of a path, against the fixtures and a stock that it cuts.
///
/// Refers to what it was given; make one where it is needed.
class LegCheck {
public:
    LegCheck(const Setup& setup, const ToolAssembly& tool, FluteUse use, StockHints& hints,
             Statistics& statistics)
        : setup_(setup), tool_(tool), use_(use), hints_(hints), statistics_(statistics) {}

    /// Checks one leg, cuts the stock along it, and adds what was found to `pairs`, with times
    /// counted from `start`, seconds. While the flutes cut, shank and holder are held against the
    /// stock as it is: `lower` against the stock at the start of a stretch, `upper` against what is
    /// left at its end, and a stretch that leaves a doubt is halved until it is no longer than the
    /// mesh size.
    ///
    /// Result: the volume removed, mm3.
    double run(const Leg& leg, double start, CutModel& stock, std::vector<PairClearance>& pairs);

    /// Checks the tool at rest, without cutting.
    void rest(const Vec3& place, const CutModel& stock, std::vector<PairClearance>& pairs);

    /// The least share of the leg after which the pair is as near as `distance` for the first time.
    double earliest(const Leg& leg, const Pair& pair, double distance, const CutModel& stock);

private:
    using Shapes = std::vector<ConvexShape>;

    /// What one state of the stock says of a part: as it is, and shrunk by the contact depth.
    struct Observation {
        Separation plain;
        Separation shrunk;
    };

    Shapes shapes(const RevolvedProfile& profile, const Leg& leg) const;
    Separation to_fixture(const Shapes& shapes, const Fixture& fixture, double limit);
    Separation to_stock(PartKind part, const Shapes& shapes, const CutModel& stock,
                        double threshold, double limit);

    void check_fixtures(const Leg& leg, double start, std::vector<PairClearance>& pairs);
    void check_fixture(const Leg& leg, double start, size_t fixture, const ToolPart& part,
                       std::vector<PairClearance>& pairs);

    /// A part of a cutting tool before the stock is cut, and whether it is clear of it already.
    struct PartCheck {
        const ToolPart& part;
        Observation before;
        bool clear;
    };

    /// Looks no farther than `nearest`.
    Observation observe(const ToolPart& part, const Leg& leg, const CutModel& stock,
                        double nearest);
    /// Whether the part goes only where the flutes have cut before (see runs_in_own_cut).
    bool retraces(const ToolPart& part, const Leg& leg, const CutModel& stock,
                  const Allowance& allowance) const;
    /// Whether a part that is too near the stock before the cut is clear of what is left after it.
    bool depends_on_time(const std::vector<PartCheck>& checks, const Leg& leg,
                         const CutModel& stock);
    Observation look_again(const PartCheck& check, const Leg& leg, const CutModel& stock);
    PairClearance clearance(const ToolPart& part, const Leg& leg, double start,
                            const Observation& before, const Observation& after) const;
    /// Adds the pairs of all parts with the stock; whether the flutes gouge it.
    bool check_parts(const Leg& leg, double start, const CutModel& stock,
                     std::vector<PairClearance>& pairs);
    void check_hull(const Leg& leg, double start, const CutModel& stock,
                    std::vector<PairClearance>& pairs);
    double check_cutting(const Leg& leg, double start, CutModel& stock,
                         std::vector<PairClearance>& pairs);
    double check_not_cutting(const Leg& leg, double start, CutModel& stock,
                             std::vector<PairClearance>& pairs);
    double cut_along(const Leg& leg, CutModel& stock);

    const Setup& setup_;
    const ToolAssembly& tool_;
    FluteUse use_;
    StockHints& hints_;
    Statistics& statistics_;
};

} // namespace core
