#pragma once

#include <memory>
#include <optional>

#include "core/sim/leg/leg_context.h"

namespace core {

struct TurningPart;

/// Cuts the stock with the flutes along legs, and records the cuts through expendable fixtures.
/// Refers to the context.
class FluteCut {
public:
    explicit FluteCut(const LegContext& context) : context_(context) {}

    /// Cuts the stock along a straight leg. If the tool turns, the flutes are cut in parts, each in
    /// as many halves of the leg as it needs.
    ///
    /// Result: the volume removed, mm3.
    double along(const Leg& leg, CutModel& stock);

    /// The same as a trial; none without a tool. The tool must hardly turn.
    std::unique_ptr<TrialCut> try_along(const Leg& leg, CutModel& stock);
    /// Keeps such a trial; the volume removed, mm3.
    double keep(TrialCut& trial, const Leg& leg, const CutModel& stock);

    /// The move that the flutes make on a straight leg. There must be a tool.
    CutterSweep sweep_on(const Leg& leg);

    /// Removes everything from `certain` that the flutes may have removed on a leg whose contact
    /// with the stock is undecided, and records a straight one as a passage.
    void may_cut(const Leg& leg, CutModel& certain);

    /// Records that the flutes cut an expendable fixture on a leg.
    void note_cut(const Leg& leg, size_t fixture);

    /// Whether the flutes pass through an expendable fixture only where they have cut it before.
    bool is_in_own_cut(const Leg& leg, size_t fixture) const;

private:
    /// The profile that cuts.
    const RevolvedProfile& cutting_profile() const;
    /// `part`: 0 is the whole.
    std::shared_ptr<const Cutter> cutter_for(const RelativeLeg& leg, size_t part,
                                             const RevolvedProfile& profile);
    CutterSweep sweep_on(const RelativeLeg& way);
    CutterSweep sweep_on(const RelativeLeg& way, std::shared_ptr<const Cutter> cutter) const;
    const std::vector<TurningPart>& parts();
    /// Cuts with one part.
    double along(const Leg& leg, size_t part, CutModel& stock);
    double cut_with(const CutterSweep& sweep, CutModel& stock);
    /// Whether a profile certainly stays away from the stock on a leg.
    bool is_away(const RevolvedProfile& profile, const RelativeLeg& way,
                 const CutModel& stock) const;

    const LegContext& context_;
};

/// Transform from the frame of a fixture to that of the stock, at these axis values.
Transform stock_from_fixture(const Setup& setup, size_t fixture, const AxisValues& values);

} // namespace core
