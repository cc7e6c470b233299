#pragma once

#include <memory>
#include <optional>

#include "core/sim/leg/leg_context.h"

namespace core {

/// Cuts the stock with the flutes along legs, and records the cuts through expendable fixtures.
/// Refers to the context.
class FluteCut {
public:
    explicit FluteCut(const LegContext& context) : context_(context) {}

    /// Cuts the stock along a straight leg on which the tool hardly turns.
    ///
    /// Result: the volume removed, mm3.
    double along(const Leg& leg, CutModel& stock);

    /// The same as a trial; none without a tool.
    std::unique_ptr<TrialCut> try_along(const Leg& leg, CutModel& stock);
    /// Keeps such a trial; the volume removed, mm3.
    double keep(TrialCut& trial, const Leg& leg, const CutModel& stock);

    /// The move that the flutes make on a straight leg. There must be a tool.
    CutterSweep sweep_on(const Leg& leg);

    /// Cuts the stock along any leg; halves the leg while the tool turns too far.
    double along_turning(const Leg& leg, CutModel& stock);

    /// Removes everything from `certain` that the flutes may have removed on a leg whose contact
    /// with the stock is undecided, and records a straight one as a passage.
    void may_cut(const Leg& leg, CutModel& certain);

    /// Records that the flutes cut an expendable fixture on a leg.
    void note_cut(const Leg& leg, size_t fixture);

    /// Whether the flutes pass through an expendable fixture only where they have cut it before.
    bool is_in_own_cut(const Leg& leg, size_t fixture) const;

private:
    std::shared_ptr<const Cutter> cutter_for(const RelativeLeg& leg);
    CutterSweep sweep_on(const RelativeLeg& way);

    const LegContext& context_;
};

/// Transform from the frame of a fixture to that of the stock, at these axis values.
Transform stock_from_fixture(const Setup& setup, size_t fixture, const AxisValues& values);

} // namespace core
