#include "app/session/control_walk.h"

#include <algorithm>
#include <cassert>

namespace app {

ControlWalk::ControlWalk(RecordedRun& run, size_t place)
    : run_(run),
      place_(place),
      interpreter_(run.library(), run.check().file.environment),
      control_(run.place_at(place)->control) {}

void ControlWalk::advance() {
    [[maybe_unused]] const auto block = interpreter_.next(control_);
    assert(block && *block);
    ++place_;
    const auto& changes = run_.changes();
    if (std::any_of(changes.begin(), changes.end(),
                    [this](const MadeChange& made) { return made.block == place_; }))
        control_ = run_.place_at(place_)->control;
}

} // namespace app
