#include "app/report/sheet/sheet_words.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/base/text.h"
#include "core/base/units.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"
#include "render/setup_scene.h"

namespace app {

std::string SheetUnit::length(double mm) const {
    return inch ? core::number_text(mm / core::mm_per_inch, 4) : core::number_text(mm, 3);
}

std::string SheetUnit::signed_length(double mm) const {
    const std::string text = length(mm);
    return text[0] == '-' ? text : "+" + text;
}

std::string SheetUnit::at_least(double mm) const {
    return core::without_trailing_zeros(inch ? core::at_most(mm / core::mm_per_inch, 4)
                                             : core::at_most(mm, 2));
}

core::Aabb extents_of(const core::ExactBody& body, const core::Transform& zero_from_body) {
    if (const auto* shape = std::get_if<core::ConvexShape>(&body))
        return core::bounds(core::ExactBody(core::posed(*shape, zero_from_body)));
    core::Aabb box;
    for (const core::Vec3& vertex : std::get<core::SolidMesh>(body).mesh->vertices)
        box.extend(zero_from_body * vertex);
    return box;
}

namespace {

constexpr double same_place = 1e-3; // mm

/// Whether a rotation is made of quarter turns.
bool keeps_axes(const core::Mat3& rotation) {
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) {
            const double entry = std::abs(rotation[column][row]);
            if (entry > 1e-9 && std::abs(entry - 1.0) > 1e-9) return false;
        }
    return true;
}

core::Aabb turned_box(const core::Aabb& box, const core::Transform& pose) {
    core::Aabb turned;
    for (const double x : {box.min.x, box.max.x})
        for (const double y : {box.min.y, box.max.y})
            for (const double z : {box.min.z, box.max.z}) turned.extend(pose * core::Vec3(x, y, z));
    return turned;
}

/// Where a place of the stock is along one axis.
enum class Spot : uint8_t { low, middle, high };

/// The spot nearest to 0; the middle only if 0 is there.
Spot spot_near_zero(double low, double high) {
    if (std::abs(0.5 * (low + high)) <= same_place) return Spot::middle;
    return std::abs(low) <= std::abs(high) ? Spot::low : Spot::high;
}

double place_of(Spot spot, double low, double high) {
    return spot == Spot::low ? low : spot == Spot::high ? high : 0.5 * (low + high);
}

/// "left front top", without the axes in the middle.
std::string side_words(const std::array<Spot, 3>& spots) {
    constexpr const char* names[3][2] = {{"left", "right"}, {"front", "back"}, {"bottom", "top"}};
    std::string words;
    for (size_t axis = 0; axis < 3; ++axis)
        if (spots[axis] != Spot::middle)
            words += fmt::format("{}{}", words.empty() ? "" : " ",
                                 names[axis][spots[axis] == Spot::high ? 1 : 0]);
    return words;
}

std::string spot_words(const std::array<Spot, 3>& spots) {
    const std::string sides = side_words(spots);
    const auto middles = std::count(spots.begin(), spots.end(), Spot::middle);
    if (middles == 0) return fmt::format("the {} corner of the stock", sides);
    if (middles == 1) return fmt::format("the middle of the {} edge of the stock", sides);
    if (middles == 3) return "the centre of the stock";
    const bool is_level = spots[2] != Spot::middle; // the top or the bottom
    return fmt::format("the centre of the {}{} of the stock", sides, is_level ? "" : " side");
}

} // namespace

std::optional<core::Aabb> stock_extents(const core::Solid& stock,
                                        const core::Transform& zero_from_stock) {
    if (!keeps_axes(zero_from_stock.rotation)) return {};
    return turned_box(core::bounds(stock), zero_from_stock);
}

bool is_round_about_z(const core::Solid& stock, const core::Transform& zero_from_stock) {
    const auto* cylinder = std::get_if<core::SolidCylinder>(&stock.shape);
    return cylinder != nullptr && std::abs(zero_from_stock.rotation[cylinder->axis].z) > 0.5;
}

std::string place_on_stock(const core::Aabb& box, bool is_round, const SheetUnit& unit) {
    std::array<Spot, 3> spots{};
    std::string distances;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = box.min[axis], high = box.max[axis];
        Spot& spot = spots[static_cast<size_t>(axis)];
        spot = is_round && axis < 2 ? Spot::middle : spot_near_zero(low, high);
        const double from_spot = -place_of(spot, low, high);
        if (std::abs(from_spot) > same_place)
            distances += fmt::format("{}{} ", "XYZ"[axis], unit.signed_length(from_spot));
    }
    return distances.empty() ? spot_words(spots) : distances + "from " + spot_words(spots);
}

std::vector<PlacedFixture> placed_fixtures(const core::Setup& setup,
                                           const core::Transform& zero_from_stock) {
    core::AxisValues home{};
    const core::AxisPosition stated = setup.machine.home();
    for (size_t axis = 0; axis < home.size(); ++axis) home[axis] = stated[axis].value_or(0.0);
    std::vector<PlacedFixture> placed;
    for (const core::Fixture& fixture : setup.fixtures) {
        if (fixture.is_machine) continue;
        const core::Transform pose = render::stock_from_mount(setup, fixture.mount, home);
        placed.push_back({&fixture, extents_of(fixture.body, zero_from_stock * pose)});
    }
    return placed;
}

namespace {

/// Whether a fixture touches a side of the stock, below its top. `sign`: -1 the side at the smaller
/// coordinate.
bool holds_side(const core::Aabb& jaw, const core::Aabb& stock, int axis, int sign) {
    constexpr double touch = 0.1; // mm
    const int across = 1 - axis;
    const double gap = sign < 0 ? stock.min[axis] - jaw.max[axis] : jaw.min[axis] - stock.max[axis];
    return std::abs(gap) <= touch && jaw.min[across] < stock.max[across]
           && jaw.max[across] > stock.min[across] && jaw.min.z < stock.max.z
           && jaw.max.z > stock.min.z && jaw.max.z < stock.max.z;
}

/// The box of a mesh need not be where its material is, so another mesh than a jaw does not count.
bool may_be_jaw(const core::Fixture& fixture) {
    return fixture.is_there
           && (render::is_vise(fixture.name)
               || std::holds_alternative<core::ConvexShape>(fixture.body));
}

/// The top of the highest fixture that holds a side; empty if there is none.
std::optional<double> jaw_top(const std::vector<PlacedFixture>& fixtures, const core::Aabb& stock,
                              int axis, int sign) {
    std::optional<double> top;
    for (const PlacedFixture& placed : fixtures)
        if (may_be_jaw(*placed.fixture) && holds_side(placed.box, stock, axis, sign))
            top = std::max(top.value_or(placed.box.max.z), placed.box.max.z);
    return top;
}

} // namespace

std::optional<double> height_above_jaws(const std::vector<PlacedFixture>& fixtures,
                                        const core::Aabb& stock) {
    std::optional<double> height;
    for (const int axis : {0, 1}) {
        const auto low = jaw_top(fixtures, stock, axis, -1),
                   high = jaw_top(fixtures, stock, axis, 1);
        if (!low || !high) continue;
        const double out = stock.max.z - std::max(*low, *high);
        height = std::min(height.value_or(out), out);
    }
    return height;
}

} // namespace app
