#pragma once

#include <span>

#include "tests/bench/contestant.h"

namespace bench {

/// A place of B for one query, with the name it has in the results.
struct Pose {
    std::string name;
    core::Transform a_from_b;
};

/// The eight gaps between the surfaces that the targets are for, mm.
inline constexpr double gaps[] = {0.5, 1, 2, 5, 10, 20, 30, 50};

/// A direction that no face, edge or scan line of the bodies runs along.
core::Vec3 generic_direction();

/// B turned, then moved along `direction` to centre distances of `touching` plus each gap.
std::vector<Pose> gap_poses(double touching, const core::Vec3& direction,
                            const core::Vec3& angles_deg = core::Vec3(0.0));

/// B above A: its lower face 5, 7.5, 10 and 15 mm above A's upper one, which `touching` is the
/// centre distance for; turned about Z and shifted sideways.
std::vector<Pose> faces_apart(double touching, double angle_deg, const core::Vec3& sideways);

/// B turned this way and that, each time come up along another direction to a gap of points that
/// goes from 0.5 to 20 mm.
std::vector<Pose> approaches(const Query& exact, int count);

/// A pin in a cup, tilted and off the middle, down to 0.3 mm from the wall.
std::vector<Pose> pin_poses();

/// A ring through another ring, at three places.
std::vector<Pose> linked_poses();

/// 10,000 small steps of a ball of 50 mm round another one: eight straight lines, an octagon in
/// a plane of no special direction, 1 mm apart in the middle of each and 5.2 mm at the corners;
/// 0.034 mm and 0.01 degrees a step.
std::vector<core::Transform> path_round_a_ball();

} // namespace bench
