#include "hwsim/tool_model.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "hwsim/memory_line.h"

namespace hwsim {
namespace {

using core::ProfileElement;

/// A convex piece of revolution in the half plane of radius and height, as its outline.
class Outline {
public:
    explicit Outline(const ProfileElement& e) : e_(e) {
        const double length = core::hypot(e.r1 - e.r0, e.z1 - e.z0);
        if (length > 0.0) normal_ = {(e.z1 - e.z0) / length, (e.r0 - e.r1) / length};
        borders_ = {bottom(), e.z0, e.z0 + e.margin * normal_[1], e.z1 + e.margin * normal_[1],
                    e.z1,     top()};
    }

    double bottom() const { return e_.z0 - e_.margin; }
    double top() const { return e_.z1 + e_.margin; }

    /// The greatest radius between two heights. Between borders the outline is a straight line or
    /// part of one rounding, which has its greatest radius at an end.
    double radius_within(double low, double high) const {
        double radius = std::max(radius_at(low), radius_at(high));
        for (const double z : borders_)
            if (z > low && z < high) radius = std::max(radius, radius_at(z));
        return radius;
    }

    /// The signed distance of a point of the half plane.
    double outside(double r, double z) const {
        const double z_in = std::clamp(z, e_.z0, e_.z1);
        const double r_in = radius_of_core(z_in);
        double apart = core::hypot(std::max(r - r_in, 0.0), z - z_in);
        // The nearest point may be on the slope instead of straight sideways or below.
        const double along_r = e_.r1 - e_.r0, along_z = e_.z1 - e_.z0;
        const double square = along_r * along_r + along_z * along_z;
        if (square > 0.0) {
            const double t =
                std::clamp(((r - e_.r0) * along_r + (z - e_.z0) * along_z) / square, 0.0, 1.0);
            const double on_r = e_.r0 + t * along_r, on_z = e_.z0 + t * along_z;
            apart = std::min(apart, core::hypot(r - on_r, z - on_z));
        }
        for (const auto& [rim, height] : {std::pair{e_.r0, e_.z0}, {e_.r1, e_.z1}})
            apart = std::min(apart, core::hypot(std::max(r - rim, 0.0), z - height));
        return std::max(apart - e_.margin, 0.0);
    }

private:
    double radius_of_core(double z) const {
        if (e_.z1 <= e_.z0) return std::max(e_.r0, e_.r1);
        return e_.r0 + (e_.r1 - e_.r0) * (z - e_.z0) / (e_.z1 - e_.z0);
    }

    /// The outline is the outermost of the two roundings and the slope between them.
    double radius_at(double z) const {
        double radius = 0.0;
        for (const auto& [rim, height] : {std::pair{e_.r0, e_.z0}, {e_.r1, e_.z1}}) {
            const double apart = std::abs(z - height);
            if (apart <= e_.margin)
                radius =
                    std::max(radius, rim + std::sqrt((e_.margin - apart) * (e_.margin + apart)));
        }
        if (z >= e_.z0 && z <= e_.z1) radius = std::max(radius, radius_of_core(z));
        const double low = borders_[2], high = borders_[3];
        if (high > low && z >= low && z <= high) {
            const double share = (z - low) / (high - low);
            radius = std::max(radius, e_.r0 + share * (e_.r1 - e_.r0) + e_.margin * normal_[0]);
        }
        return radius;
    }

    ProfileElement e_;
    std::array<double, 2> normal_{1.0, 0.0}; // of the slope, outwards: r, z
    std::array<double, 6> borders_{};
};

constexpr double model_safety = 1e-9; // mm: larger than the rounding of the doubles here

core::Result<Record> cylinder(double low, double high, double radius) {
    FEELER_TRY(const int32_t z0, fixed(low - model_safety, Rounding::down));
    FEELER_TRY(const int32_t z1, fixed(high + model_safety, Rounding::up));
    FEELER_TRY(const int32_t r, fixed(radius + model_safety, Rounding::up));
    if (z1 - z0 > Record::greatest_extent || r > Record::greatest_extent)
        return core::fail(core::ErrorCode::invalid_value,
                          "a part of a tool is larger than the coprocessor's limit of 256 mm");
    return Record{{0, 0, z0}, z1 - z0, r};
}

core::Result<void> add_slices(std::vector<Record>& records, const Outline& outline, double low,
                              double high, double tolerance, int depth) {
    const double radius = outline.radius_within(low, high);
    const bool is_good =
        outline.outside(radius, low) <= tolerance && outline.outside(radius, high) <= tolerance
        && high - low <= length_of(Record::greatest_extent) - 2 * lsb - 2 * model_safety;
    if (is_good || depth == 0) {
        FEELER_TRY(const Record record, cylinder(low, high, radius));
        records.push_back(record);
        return {};
    }
    const double middle = 0.5 * (low + high);
    if (auto made = add_slices(records, outline, low, middle, tolerance, depth - 1); !made)
        return made;
    return add_slices(records, outline, middle, high, tolerance, depth - 1);
}

} // namespace

core::Result<std::vector<Record>> cylinders_round(const core::RevolvedProfile& profile,
                                                  double tolerance) {
    constexpr int most_halvings = 12;
    if (profile.empty() || !(tolerance > 0.0))
        return core::fail(core::ErrorCode::invalid_value,
                          "a tool model needs at least one piece and a tolerance above 0");
    std::vector<Record> records;
    for (const ProfileElement& element : profile.elements) {
        const Outline outline(element);
        if (auto made = add_slices(records, outline, outline.bottom(), outline.top(), tolerance,
                                   most_halvings);
            !made)
            return tl::unexpected(std::move(made).error());
    }
    return records;
}

std::vector<Record> cylinders_round(const std::vector<Record>& posts) {
    std::vector<Record> cylinders = posts;
    for (Record& c : cylinders)
        c.half = static_cast<int32_t>(root_up(2 * int64_t{c.half} * c.half));
    return cylinders;
}

} // namespace hwsim
