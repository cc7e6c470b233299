#pragma once

#include "tests/bench/poses.h"

namespace bench {

struct Bodies {
    Points a, b;
};

/// Queries that share a number in the table: their geometric mean.
struct Row {
    std::string name;
    std::vector<Pose> poses;
    core::PairGoal goal{};
    bool in_turn = false; // also measure all its poses one after the other, as pose "in-turn"
};

/// Two bodies, and all that is asked about them. They are made when their turn comes, as not all
/// fit into memory at once.
struct Scene {
    std::string name; // ends the names of the rows that it has by itself: build-NAME, warm-NAME
    std::function<Bodies()> bodies;
    std::function<std::vector<Row>(const Query& exact)> rows;
    bool with_build = false;             // measure how long the structure over A takes
    std::vector<core::Transform> path{}; // measure a pose of this path, the last answer known
};

/// Everything that is measured. All contestants get these bodies and poses.
std::vector<Scene> scenes();

} // namespace bench
