#pragma once

#include "tests/bench/poses.h"

namespace bench {

struct Bodies {
    Points a, b;
};

/// Queries with a common number in the table: their geometric mean.
struct Row {
    std::string name;
    std::vector<Pose> poses;
    core::PairGoal goal{};
    bool in_turn = false; // also measure all its poses in turn, as pose "in-turn"
};

/// Two bodies and all queries about them. They are created when needed, as not all fit into memory
/// at once.
struct Scene {
    std::string name; // suffix of the names of its own rows: build-NAME, warm-NAME
    std::function<Bodies()> bodies;
    std::function<std::vector<Row>(const Query& exact)> rows;
    bool with_build = false; // measure building the structure over A
    std::vector<core::Transform>
        path{}; // measure a pose of this path with the previous result known
};

/// All scenes. All engines get the same bodies and poses.
std::vector<Scene> scenes();

} // namespace bench
