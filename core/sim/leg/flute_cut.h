#pragma once

#include <memory>
#include <optional>

#include "core/sim/leg/leg_context.h"

namespace core {

/// Cuts with the flutes along legs: the stock, and expendable fixtures, of which it keeps the cuts
/// only. Refers to the context.
class FluteCut {
public:
    explicit FluteCut(const LegContext& context) : context_(context) {}

    /// Cuts the stock along a straight leg on which the tool hardly turns.
    ///
    /// Result: the volume removed, mm3.
    double along(const Leg& leg, CutModel& stock);

    /// The same for any leg: halves it while the tool turns too far.
    double along_turning(const Leg& leg, CutModel& stock);

    /// Records what the flutes cut of an expendable fixture on a leg.
    void note_cut(const Leg& leg, size_t fixture);

    /// Whether the flutes pass an expendable fixture only where they have cut it before.
    bool is_in_own_cut(const Leg& leg, size_t fixture) const;

private:
    std::shared_ptr<const Cutter> cutter_for(const RelativeLeg& leg);

    const LegContext& context_;
};

/// From the frame of a fixture to that of the stock, at these axis values.
Transform stock_from_fixture(const Setup& setup, size_t fixture, const AxisValues& values);

} // namespace core
