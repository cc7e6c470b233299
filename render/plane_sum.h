#pragma once

#include "core/base/transform.h"

namespace render {

/// The squared distances of a point from planes, each times a weight, as a function of the point.
///
/// Source: Garland and Heckbert: Surface simplification using quadric error metrics, 1997.
struct PlaneSum {
    core::Mat3 square = core::Mat3(0.0);
    core::Vec3 toward = core::Vec3(0.0);
    double constant = 0.0;

    /// A plane through a place; `normal` has length 1.
    void add(const core::Vec3& normal, const core::Vec3& place, double weight) {
        const double height = glm::dot(normal, place);
        square += weight * glm::outerProduct(normal, normal);
        toward += weight * height * normal;
        constant += weight * height * height;
    }
    void add(const PlaneSum& other) {
        square += other.square;
        toward += other.toward;
        constant += other.constant;
    }

    double at(const core::Vec3& p) const {
        return glm::dot(p, square * p) - 2.0 * glm::dot(toward, p) + constant;
    }
    /// Where it is least; along directions that the planes leave open, near `guess`.
    core::Vec3 least(const core::Vec3& guess) const {
        const double weight = 1e-5 * (square[0][0] + square[1][1] + square[2][2]) + 1e-300;
        return glm::inverse(square + weight * core::Mat3(1.0)) * (toward + weight * guess);
    }
};

} // namespace render
