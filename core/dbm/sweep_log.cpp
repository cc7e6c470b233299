#include "core/dbm/sweep_log.h"

namespace core {

void SweepLog::push_back(const CutterSweep& sweep) {
    const bool same_attitude = !attitudes_.empty() && attitudes_.back().cutter == sweep.cutter
                               && attitudes_.back().orientation == sweep.orientation;
    if (!same_attitude)
        attitudes_.push_back({sweep.cutter, sweep.orientation,
                              bounds(CutterSweep{sweep.cutter, {}, {}, sweep.orientation})});
    if (places_.empty() || places_.back() != sweep.from) places_.push_back(sweep.from);
    places_.push_back(sweep.to);
    entries_.push_back({static_cast<uint32_t>(places_.size() - 1),
                        static_cast<uint32_t>(attitudes_.size() - 1), sweep.block});
}

Aabb SweepLog::box(size_t i) const {
    const Entry& entry = entries_[i];
    Aabb path;
    path.extend(places_[entry.end - 1]);
    path.extend(places_[entry.end]);
    const Aabb& body = attitudes_[entry.attitude].body;
    return {path.min + body.min, path.max + body.max};
}

LoggedSweep SweepLog::operator[](size_t i) const {
    const Entry& entry = entries_[i];
    const Attitude& attitude = attitudes_[entry.attitude];
    return {{attitude.cutter, places_[entry.end - 1], places_[entry.end], attitude.orientation,
             entry.block},
            box(i)};
}

void append(SharedLog<SweepRun>& runs, uint32_t number) {
    if (!runs.empty() && runs.back().last + 1 == number)
        runs.replace_back({runs.back().first, number});
    else
        runs.push_back({number, number});
}

} // namespace core
