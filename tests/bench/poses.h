#pragma once

#include <span>

#include "tests/bench/contestant.h"

namespace bench {

/// A pose of B for one query, with its name in the results.
struct Pose {
    std::string name;
    core::Transform a_from_b;
};

/// The eight gaps between the surfaces for which there are targets, mm.
inline constexpr double gaps[] = {0.5, 1, 2, 5, 10, 20, 30, 50};

/// A direction parallel to no face, edge or scan line of the bodies.
core::Vec3 generic_direction();

/// B rotated, then moved along `direction` to centre distances of `touching` plus each gap.
std::vector<Pose> gap_poses(double touching, const core::Vec3& direction,
                            const core::Vec3& angles_deg = core::Vec3(0.0));

/// B above A: its lower face 5, 7.5, 10 and 15 mm above A's upper face, with `touching` as the
/// centre distance at contact; rotated about Z and shifted sideways.
std::vector<Pose> faces_apart(double touching, double angle_deg, const core::Vec3& sideways);

/// B in various orientations, each time approached along another direction to a gap of points from
/// 0.5 to 20 mm.
std::vector<Pose> approaches(const Query& exact, int count);

/// A pin in a cup, tilted and off centre, down to 0.3 mm from the wall.
std::vector<Pose> pin_poses();

/// A ring through another ring, in three positions.
std::vector<Pose> linked_poses();

/// 10,000 small steps of a 50 mm ball around another one: eight straight lines, an octagon in an
/// oblique plane, 1 mm apart in the middle of each and 5.2 mm at the corners; 0.034 mm and 0.01
/// degrees per step.
std::vector<core::Transform> path_round_a_ball();

} // namespace bench
