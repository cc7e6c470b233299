#pragma once

#include <array>
#include <optional>

#include "core/base/transform.h"
#include "gcode/axes.h"
#include "gcode/offsets.h"

namespace gcode {

/// G51: every coordinate is stretched from a centre.
struct Scaling {
    core::Vec3 factors = core::Vec3(1.0);
    core::Vec3 centre = core::Vec3(0.0);

    bool operator==(const Scaling&) const = default;
};

/// G51.1: coordinates are reflected at a place, axis by axis.
struct MirrorImage {
    std::array<bool, 3> axes{};
    core::Vec3 place = core::Vec3(0.0);

    bool operator==(const MirrorImage&) const = default;
};

/// G68: a rotation in a plane, named by the axis it is about.
struct PlaneRotation {
    int normal = 2;
    core::Vec3 centre = core::Vec3(0.0); // scaled and reflected already
    double degrees = 0.0;
    bool is_reversed = false; // one axis of the plane was reflected before

    bool operator==(const PlaneRotation&) const = default;
};

/// G68.2: coordinates of a plane that stands anywhere in the work coordinates.
struct TiltedPlane {
    core::Mat3 axes = core::Mat3(1.0); // its directions as columns
    core::Vec3 origin = core::Vec3(0.0);

    bool operator==(const TiltedPlane&) const = default;
};

/// G16: positions in the plane are a radius and an angle.
struct PolarPositions {
    std::array<double, 2> origin{};
    std::optional<double> radius, angle_deg; // empty until the program says them

    bool operator==(const PolarPositions&) const = default;
};

/// What a program has said about its own coordinates, each until it is cancelled.
struct ProgramTransforms {
    std::optional<Scaling> scaling;
    MirrorImage mirror;
    std::optional<PlaneRotation> rotation;
    std::optional<TiltedPlane> tilt;
    bool follows_vectors = false; // G43.5: motions say where the tool points to
    std::optional<PolarPositions> polar;
    std::optional<Position> before_rotation; // what the program called the place where G68 stood

    bool operator==(const ProgramTransforms&) const = default;
};

/// The rotation about a principal axis, 0 X to 2 Z; exact at multiples of 90 degrees.
core::Mat3 turned_about(int axis, double degrees);

/// All transforms as one map from program to work coordinates: first the mirror image, then the
/// scaling, the rotation, the tilted plane.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, 6, "Scaling and coordinate system rotation" and
///         "Programmable mirror image": the order, and that a mirror image of one axis of the plane
///         reverses the angle of G68.
ProgramFrame frame_of(const ProgramTransforms& transforms);

/// Where mirror image and scaling put a place.
core::Vec3 scaled_place(const ProgramTransforms& transforms, const core::Vec3& place);

} // namespace gcode
