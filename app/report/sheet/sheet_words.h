#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/dbm/solid.h"
#include "core/distance/body_distance.h"

namespace core {
struct Fixture;
struct Setup;
} // namespace core

namespace app {

/// Lengths of a set-up sheet: in mm with three decimals, or in inches with four, rounded to the
/// nearest. Limits are written by range_text, which rounds them to the safe side.
struct SheetUnit {
    bool inch = false;

    const char* name() const { return inch ? "in" : "mm"; }
    std::string length(double mm) const;
    std::string signed_length(double mm) const;
    /// A length that must not be less than this: rounded up.
    std::string at_least(double mm) const;
};

/// The box of a body in the frame of a zero: exact to rounding, also for a turned mesh.
core::Aabb extents_of(const core::ExactBody& body, const core::Transform& zero_from_body);

/// The box of the nominal stock in the frame of a zero; empty if the stock is turned against that
/// frame by other than quarter turns.
std::optional<core::Aabb> stock_extents(const core::Solid& stock,
                                        const core::Transform& zero_from_stock);

/// Whether a stock is a cylinder that stands along Z of a frame.
bool is_round_about_z(const core::Solid& stock, const core::Transform& zero_from_stock);

/// Where the origin of a frame is on the stock, with `box` as by stock_extents: "the left front top
/// corner of the stock"; "the centre of the top of the stock"; else with the distances from the
/// nearest such place: "X+5 Z-2 from the left front top corner of the stock". Left is towards
/// smaller X, front towards smaller Y. A round stock has only centres.
std::string place_on_stock(const core::Aabb& box, bool is_round, const SheetUnit& unit);

/// A fixture with its box in the frame of the first zero.
struct PlacedFixture {
    const core::Fixture* fixture = nullptr;
    core::Aabb box;
};

/// The fixtures of a set-up without the bodies of its machine, at the start of the program. Those
/// that later lines put in place are included.
std::vector<PlacedFixture> placed_fixtures(const core::Setup& setup,
                                           const core::Transform& zero_from_stock);

/// How far the stock stands out above two fixtures that hold it on opposite sides, mm; empty if
/// there are none. They touch these sides, end below the top of the stock, and are convex or jaws
/// by their names.
std::optional<double> height_above_jaws(const std::vector<PlacedFixture>& fixtures,
                                        const core::Aabb& stock);

} // namespace app
