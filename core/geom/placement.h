#pragma once

#include "core/base/vec.h"
#include "core/geom/mesh_features.h"

namespace core {

/// The plane of a face: any of its points and its normal outwards, of length 1.
struct FacePlane {
    Vec3 point = Vec3(0.0);
    Vec3 normal = Vec3(0.0, 0.0, 1.0);
};

/// The plane of a face, with the middle of the face as its point.
inline FacePlane plane_of(const PlanarFace& face) { return {face.center, face.normal}; }

inline FacePlane moved(const FacePlane& plane, const Transform& target_from_plane) {
    return {target_from_plane * plane.point, target_from_plane.rotation * plane.normal};
}

/// A matrix that is a rotation but for rounding, as a rotation. Entries within 1e-12 of -1, 0 or 1
/// are exact if all are; so rotations by multiples of 90 degrees carry no rounding.
Mat3 tidied(const Mat3& rotation);

/// The rotation by the least angle that turns one direction into another, both of length 1.
///
/// Result:  exact between axes of the frame. For opposite directions, half a turn about Z, X or Y,
///          the first that is at right angles to them; so a body that stands keeps standing.
Mat3 least_rotation(const Vec3& from, const Vec3& to);

/// How a face is put to another one.
struct FaceFit {
    bool flush = false;   // the faces look the same way; otherwise they face each other
    bool centred = false; // also brings the point of the moving face above that of the fixed one
    double offset = 0.0;  // from the fixed face, outwards, mm
};

/// The pose of a body in which one of its faces is in the plane of a fixed face.
///
/// The body turns about the point of its face by the least rotation that makes the normals opposed
/// or equal, and then moves along the fixed normal only, unless it is centred.
///
/// Frame:   `moving` is in the frame of the body, `fixed` and the poses are in the machine's.
/// Result:  a body that needs no rotation keeps its rotation to the last bit.
Transform face_to_face(const FacePlane& moving, const FacePlane& fixed, const Transform& pose,
                       const FaceFit& fit = {});

/// The part of a line that a body covers: least and greatest product with its direction, mm.
struct BodyExtent {
    double from = infinity;
    double to = -infinity;
};

/// How far a mesh extends along a direction. `pose` maps the mesh to the frame of the direction.
BodyExtent extent_along(const Mesh& mesh, const Transform& pose, const Vec3& direction);

/// The translation along a direction that brings a body into the middle between two faces.
///
/// `body` is its extent along `direction`, which has length 1.
Vec3 centred_between(const BodyExtent& body, const Vec3& direction, const FacePlane& a,
                     const FacePlane& b);

} // namespace core
