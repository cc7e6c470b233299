#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "app/session/kept_boxes.h"
#include "app/session/run_place.h"

namespace app {

/// A place that is kept, to come back from. It shares with the keyframe before it what is the same.
struct Keyframe {
    size_t blocks = 0;    // that were run before it
    double seconds = 0.0; // of work from the first place to here
    RunPlace place;       // but for the boxes round its lines and columns
    std::array<KeptBoxes, 4> boxes;
    size_t bytes = 0; // that it does not share with the keyframe before it

    RunPlace restored() const;
};

/// Places along a run, kept within a budget of memory: close to one another where the run is looked
/// at, and farther apart the farther it is from there.
class Keyframes {
public:
    explicit Keyframes(size_t memory_budget) : budget_(memory_budget) {}

    /// Keeps a place if it is far enough from the one before it.
    void note(size_t blocks, double seconds, const RunPlace& place);

    /// The last one at or before a place; there is one, once the first place was added.
    const Keyframe& before(size_t blocks) const;

    /// Where the run is looked at, in seconds of work.
    void look_at(double seconds) { focus_ = seconds; }

    /// Forgets those after a place.
    void drop_after(size_t blocks);

    size_t memory() const { return memory_; }
    size_t size() const { return frames_.size(); }
    const std::vector<Keyframe>& frames() const { return frames_; }

private:
    /// Where the first keyframe behind a place is, or would be.
    size_t index_after(size_t blocks) const;
    /// Whether a keyframe there would be worth its memory.
    bool wants(size_t blocks, double seconds) const;
    void thin_out();
    void remove(size_t index);
    /// How bad it would be to go without a keyframe: 1 is a wait that is noticed.
    double worth(size_t index) const;

    size_t budget_;
    size_t memory_ = 0;
    double focus_ = 0.0;
    std::vector<Keyframe> frames_ = {};
};

} // namespace app
