#pragma once

#include "core/dbm/cutter.h"
#include "core/dbm/shared_log.h"

namespace core {

/// One move of a cutter that was carried out, with the box of what it may have removed.
struct LoggedSweep {
    CutterSweep sweep;
    Aabb box;
};

/// The moves that were carried out, in order. A move that goes on where the last one ended, with
/// the same cutter held the same way, takes some 36 bytes.
class SweepLog {
public:
    size_t size() const { return entries_.size(); }
    void push_back(const CutterSweep& sweep);

    LoggedSweep operator[](size_t i) const;
    uint32_t block(size_t i) const { return entries_[i].block; }
    /// The box of what move `i` may have removed.
    Aabb box(size_t i) const;

private:
    /// A cutter and how it is held; `body` is its box about its tip.
    struct Attitude {
        std::shared_ptr<const Cutter> cutter;
        Mat3 orientation;
        Aabb body;
    };
    struct Entry {
        uint32_t end; // the move goes from place end - 1 to place end
        uint32_t attitude;
        uint32_t block;
    };
    SharedLog<Attitude> attitudes_;
    SharedLog<Vec3> places_;
    SharedLog<Entry> entries_;
};

/// The numbers first .. last of moves in a log.
struct SweepRun {
    uint32_t first = 0, last = 0;
};

/// Adds the newest move to a list of runs.
void append(SharedLog<SweepRun>& runs, uint32_t number);

} // namespace core
