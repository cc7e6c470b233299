#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/setup/presets/preset.h"
#include "app/setup/presets/preset_solid.h"
#include "app/setup/presets/vise_fit.h"
#include "core/geom/mesh_features.h"
#include "core/geom/mesh_file.h"
#include "core/geom/triangle_distance.h"

/// The presets of fixtures, compared with descriptions of the true bodies, with true circles.

namespace app_test {
namespace {

using app::Preset;
using app::PresetSizes;
using app::PresetValues;
using core::Vec3;
using testing::HasSubstr;

/// Whether a point is in a part of a body, where the part is larger all round by `grown`.
using Part = std::function<bool(const Vec3&, double grown)>;

Part box(const Vec3& low, const Vec3& high) {
    return [=](const Vec3& p, double grown) {
        for (int axis = 0; axis < 3; ++axis)
            if (p[axis] < low[axis] - grown || p[axis] > high[axis] + grown) return false;
        return true;
    };
}

/// A cylinder along an axis, about the point that the other two axes give.
Part round(int axis, const Vec3& centre, double radius, double low, double high) {
    return [=](const Vec3& p, double grown) {
        const Vec3 d = p - centre;
        const double u = d[(axis + 1) % 3], v = d[(axis + 2) % 3];
        return std::hypot(u, v) <= radius + grown && p[axis] >= low - grown
               && p[axis] <= high + grown;
    };
}

/// A hexagonal prism along Z with corners towards X.
Part hexagonal(double x, double across, double low, double high) {
    return [=](const Vec3& p, double grown) {
        for (const double angle : {30.0, 90.0, 150.0}) {
            const double radians = angle * M_PI / 180;
            const double out = (p.x - x) * std::cos(radians) + p.y * std::sin(radians);
            if (std::abs(out) > across / 2 + grown) return false;
        }
        return p.z >= low - grown && p.z <= high + grown;
    };
}

/// A box, turned about Z.
Part turned(const Part& part, double angle_deg) {
    return [=](const Vec3& p, double grown) {
        const double c = std::cos(angle_deg * M_PI / 180), s = std::sin(angle_deg * M_PI / 180);
        return part({c * p.x + s * p.y, c * p.y - s * p.x, p.z}, grown);
    };
}

/// What a body is made of: parts that are there, and parts that are taken from the first `cut_from`
/// of them.
struct TrueBody {
    std::vector<Part> parts, holes;
    size_t cut_from = 0;

    bool contains(const Vec3& p, double grown) const {
        bool inside = false;
        for (size_t i = 0; i < parts.size(); ++i) {
            bool is_cut = false;
            for (const Part& hole : holes) is_cut = is_cut || (i < cut_from && hole(p, -grown));
            inside = inside || (parts[i](p, grown) && !is_cut);
        }
        return inside;
    }
};

Part box_of(double x0, double x1, double y0, double y1, double z0, double z1) {
    return box({x0, y0, z0}, {x1, y1, z1});
}

TrueBody true_vise(const PresetSizes& s) {
    const double table = -s["bed_height"], front = -s["front_length"], rear = s["rear_length"];
    const double base = s["base_width"] / 2, bed = s["bed_width"] / 2, jaw = s["jaw_width"] / 2;
    const double screw = s["screw_size"] / 2, gap = s["opening"];
    return {{box_of(-base, base, front, rear, table, table + s["base_height"]),
             box_of(-bed, bed, front, rear, table, 0),
             box_of(-jaw, jaw, 0, s["fixed_jaw_thickness"], 0, s["jaw_height"]),
             box_of(-jaw, jaw, -gap - s["moving_jaw_thickness"], -gap, 0, s["jaw_height"]),
             box_of(-screw, screw, front - s["screw_length"], front, table / 2 - screw,
                    table / 2 + screw)},
            {},
            0};
}

TrueBody true_stud(const PresetSizes& s, double x, double z, double foot) {
    const double washer = z + s["washer_thickness"], nut = washer + s["nut_height"];
    return {{round(2, {x, 0, 0}, s["washer_diameter"] / 2, z, washer),
             hexagonal(x, s["nut_across"], washer, nut),
             round(2, {x, 0, 0}, s["stud_diameter"] / 2, foot, nut + s["stud_above"])},
            {},
            0};
}

TrueBody true_strap(const PresetSizes& s, bool stepped) {
    const double length = s["strap_length"], half = s["strap_width"] / 2, low = -s["height"];
    const double block = s["block_width"] / 2, heel = length - s["heel_length"];
    TrueBody body = true_stud(s, s["stud_position"], s["strap_thickness"], low);
    body.parts.push_back(box_of(0, length, -half, half, 0, s["strap_thickness"]));
    if (!stepped) {
        body.parts.push_back(box_of(heel, heel + s["block_length"], -block, block, low, 0));
        return body;
    }
    body.parts.push_back(box_of(heel, length, -block, block, low, 0));
    for (int i = 0; i < s.count("steps_above"); ++i)
        body.parts.push_back(box_of(length + i * s["step_length"],
                                    length + (i + 1) * s["step_length"], -block, block, low,
                                    (i + 1) * s["step_height"]));
    return body;
}

TrueBody true_toe(const PresetSizes& s) {
    const double nose = s["nose_length"], half = s["width"] / 2, low = -s["height"];
    const double top = low + s["body_height"], length = s["body_length"];
    return {{box_of(0, nose, -half, half, 0, s["nose_height"]),
             box_of(nose, nose + length, -half, half, low, top),
             round(2, {nose + length / 2, 0, 0}, s["screw_diameter"] / 2, low,
                   top + s["screw_height"])},
            {},
            0};
}

TrueBody true_step_block(const PresetSizes& s) {
    TrueBody body;
    const double half = s["width"] / 2, length = s["step_length"];
    for (int i = 0; i < s.count("steps"); ++i)
        body.parts.push_back(box_of(i * length, (i + 1) * length, -half, half, 0,
                                    s["first_height"] + i * s["step_height"]));
    return body;
}

TrueBody true_plate(const PresetSizes& s) {
    const double pitch = s["hole_pitch"], thickness = s["thickness"];
    TrueBody body{{box({-s["length"] / 2, -s["width"] / 2, -thickness},
                       {s["length"] / 2, s["width"] / 2, 0})},
                  {},
                  1};
    // The holes nearest to a point decide, so one part looks at all of them.
    const double nx = std::fmax(1, std::floor(s["length"] / pitch));
    const double ny = std::fmax(1, std::floor(s["width"] / pitch));
    const double radius = s["hole_diameter"] / 2;
    if (radius > 0)
        body.holes.push_back([=](const Vec3& p, double grown) {
            for (double i = 0; i < nx; ++i)
                for (double k = 0; k < ny; ++k)
                    if (std::hypot(p.x - (i - (nx - 1) / 2) * pitch,
                                   p.y - (k - (ny - 1) / 2) * pitch)
                        < radius + grown)
                        return true;
            return false;
        });
    return body;
}

TrueBody true_table(const PresetSizes& s) {
    TrueBody body{{box({-s["length"] / 2, -s["width"] / 2, -s["thickness"]},
                       {s["length"] / 2, s["width"] / 2, 0})},
                  {},
                  1};
    const double far = 1e6;
    for (int i = 0; i < s.count("slots"); ++i) {
        const double y = (i - (s.count("slots") - 1) / 2.0) * s["slot_pitch"];
        const double throat = s["slot_width"] / 2, head = s["head_width"] / 2;
        body.holes.push_back(box_of(-far, far, y - throat, y + throat, -s["slot_depth"], far));
        body.holes.push_back(box_of(-far, far, y - head, y + head, -s["slot_depth"],
                                    s["head_depth"] - s["slot_depth"]));
    }
    return body;
}

TrueBody true_tombstone(const PresetSizes& s) {
    const double x = s["column_length"] / 2, y = s["column_width"] / 2, base = s["base_height"];
    return {{box_of(-s["base_length"] / 2, s["base_length"] / 2, -s["base_width"] / 2,
                    s["base_width"] / 2, 0, base),
             box_of(-x, x, -y, y, 0, base + s["column_height"])},
            {},
            0};
}

TrueBody true_chuck(const PresetSizes& s, int jaws) {
    TrueBody body{{round(2, {}, s["body_diameter"] / 2, -s["body_height"], 0)}, {}, 1};
    if (s["bore_diameter"] > 0)
        body.holes.push_back(round(2, {}, s["bore_diameter"] / 2, -1e6, 1e6));
    const double held = s["diameter"] / 2, half = s["jaw_width"] / 2, length = s["jaw_length"];
    const bool inside = s["inside"] == 1;
    for (int i = 0; i < jaws; ++i)
        body.parts.push_back(
            turned(box_of(inside ? std::fmax(0, held - length) : held,
                          inside ? held : held + length, -half, half, 0, s["jaw_height"]),
                   360.0 * i / jaws));
    return body;
}

TrueBody true_collet_block(const PresetSizes& s, bool hex) {
    const double length = s["length"], half = s["across_flats"] / 2;
    TrueBody body{{hex ? hexagonal(0, s["across_flats"], -length, 0)
                       : box_of(-half, half, -half, half, -length, 0),
                   round(2, {}, s["ring_diameter"] / 2, -length - s["ring_length"], -length)},
                  {},
                  2};
    if (s["bore_diameter"] > 0)
        body.holes.push_back(round(2, {}, s["bore_diameter"] / 2, -1e6, 1e6));
    return body;
}

TrueBody true_dividing_head(const PresetSizes& s) {
    const double low = -s["centre_height"], half = s["body_width"] / 2, front = -s["nose_length"];
    const double back = front - s["body_length"], base = s["base_width"] / 2;
    const double plate = s["plate_diameter"] / 2, middle = (front + back) / 2;
    // The true plate is a disc across Y, as far as it is not longer than the body.
    const double reach = s["body_length"] / 2;
    const double edge = half + s["plate_reach"];
    TrueBody body{{box_of(back, front, -half, half, low, s["body_above"]),
                   box_of(back, front, -base, base, low, low + s["base_height"]),
                   box_of(middle - std::fmin(plate, reach), middle + std::fmin(plate, reach), half,
                          edge, -plate, plate),
                   round(0, {}, s["nose_diameter"] / 2, front, 0)},
                  {},
                  4};
    if (s["bore_diameter"] > 0)
        body.holes.push_back(round(0, {}, s["bore_diameter"] / 2, -1e6, 1e6));
    return body;
}

TrueBody true_body(const Preset& preset, const PresetSizes& s) {
    const std::string_view name = preset.name;
    if (name.starts_with("vise")) return true_vise(s);
    if (name.starts_with("strap-clamp")) return true_strap(s, false);
    if (name.starts_with("step-clamp")) return true_strap(s, true);
    if (name.starts_with("stud")) return true_stud(s, 0, 0, -s["stud_below"]);
    if (name == "toe-clamp") return true_toe(s);
    if (name == "step-block") return true_step_block(s);
    if (name == "fixture-plate") return true_plate(s);
    if (name.starts_with("t-slot-table")) return true_table(s);
    if (name == "tombstone") return true_tombstone(s);
    if (name.starts_with("3-jaw-chuck")) return true_chuck(s, 3);
    if (name.starts_with("4-jaw-chuck")) return true_chuck(s, 4);
    if (name.starts_with("collet-block")) return true_collet_block(s, name.ends_with("hex"));
    if (name == "dividing-head") return true_dividing_head(s);
    const Vec3 half(s["length"] / 2, s["width"] / 2, 0);
    return {{box(-half, half + Vec3(0, 0, s["height"]))}, {}, 0};
}

/// Whether a point is inside a closed mesh: how often a ray from it passes through.
bool is_inside(const core::Mesh& mesh, const Vec3& p) {
    const Vec3 ray = glm::normalize(Vec3(0.3141, 0.5772, 0.7533));
    int crossings = 0;
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        const core::Triangle t = mesh.triangle(i);
        const auto side = [&](const Vec3& a, const Vec3& b) {
            return glm::dot(glm::cross(a - p, b - p), ray);
        };
        const double u = side(t.a, t.b), v = side(t.b, t.c), w = side(t.c, t.a);
        const bool through = (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
        const Vec3 normal = glm::cross(t.b - t.a, t.c - t.a);
        if (through && glm::dot(t.a - p, normal) / glm::dot(ray, normal) > 0) ++crossings;
    }
    return crossings % 2 == 1;
}

/// Random sizes for which there is a body: from each parameter's whole range, or near the standard.
std::pair<PresetValues, core::Mesh> random_sizes(const Preset& preset, std::mt19937& random) {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (int attempt = 0; attempt < 20000; ++attempt) {
        PresetValues values;
        const bool is_near = share(random) < 0.7;
        for (const app::PresetParameter& p : preset.parameters) {
            if (share(random) < 0.4) continue;
            const double low = is_near ? std::fmax(p.least, p.standard / 2) : p.least;
            const double high = is_near ? std::fmin(p.greatest, 1.0 + p.standard * 2) : p.greatest;
            double value = low + (high - low) * std::pow(share(random), 3);
            if (p.measure == app::PresetMeasure::count) value = std::round(value);
            values.emplace(p.key, value);
        }
        auto mesh = app::preset_mesh(preset, values);
        if (mesh) return {values, *std::move(mesh)};
        EXPECT_FALSE(mesh.error().message.empty());
    }
    ADD_FAILURE() << preset.name << ": no sizes were accepted";
    return {{}, *app::preset_mesh(preset)};
}

std::string text_of(const Preset& preset, const PresetValues& values) {
    std::string text(preset.name);
    for (const auto& [key, value] : values) text += fmt::format(" {} = {}", key, value);
    return text;
}

void expect_closed(const core::Mesh& mesh) {
    const std::vector<core::EdgeUse> uses = core::edge_uses(mesh);
    for (size_t i = 0; i < uses.size(); i += 2) {
        ASSERT_EQ(core::end_of_edge(uses, i), i + 2);
        ASSERT_NE(uses[i].upwards, uses[i + 1].upwards);
    }
    EXPECT_EQ(core::shells_of(mesh).count, 1u);
    EXPECT_GT(core::signed_volume(mesh), 0.0);
    std::vector<std::string> repairs;
    EXPECT_TRUE(core::checked_solid(mesh, repairs));
    EXPECT_THAT(repairs, testing::IsEmpty());
}

/// No two triangles meet but in a vertex or an edge that they share.
void expect_no_self_intersection(const core::Mesh& mesh) {
    std::vector<size_t> order(mesh.triangles.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::vector<core::Aabb> boxes;
    for (const size_t i : order) boxes.push_back(mesh.triangle(i).bounds());
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return boxes[a].min.y < boxes[b].min.y; });
    for (size_t i = 0; i < order.size(); ++i)
        for (size_t k = i + 1; k < order.size(); ++k) {
            const size_t a = order[i], b = order[k];
            if (boxes[b].min.y > boxes[a].max.y) break;
            if (boxes[b].min.x > boxes[a].max.x || boxes[b].max.x < boxes[a].min.x) continue;
            if (boxes[b].min.z > boxes[a].max.z || boxes[b].max.z < boxes[a].min.z) continue;
            bool share = false;
            for (const uint32_t u : mesh.triangles[a])
                for (const uint32_t v : mesh.triangles[b]) share = share || u == v;
            if (share) continue;
            ASSERT_GT(core::separation(mesh.triangle(a), mesh.triangle(b)).upper, 0.0)
                << a << " " << b;
        }
}

Vec3 point_in(const core::Aabb& box, std::mt19937& random) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis)
        p[axis] = std::uniform_real_distribution<double>(box.min[axis] - 0.5,
                                                         box.max[axis] + 0.5)(random);
    return p;
}

/// A point up to 0.1 mm above or below a random triangle.
Vec3 point_near(const core::Mesh& mesh, std::mt19937& random) {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    const core::Triangle t = mesh.triangle(random() % mesh.triangles.size());
    double u = share(random), v = share(random);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const Vec3 normal = glm::normalize(glm::cross(t.b - t.a, t.c - t.a));
    return t.a + u * (t.b - t.a) + v * (t.c - t.a) + (0.2 * share(random) - 0.1) * normal;
}

/// The mesh contains the true body and is no more than the stated deviation larger.
void expect_like(const core::Mesh& mesh, const TrueBody& body, std::mt19937& random, int points) {
    const core::SolidMesh solid = core::solid_mesh(mesh);
    const core::Aabb box = mesh.bounds();
    for (int i = 0; i < points; ++i) {
        const Vec3 p = i % 2 == 0 ? point_in(box, random) : point_near(mesh, random);
        const bool inside = is_inside(mesh, p);
        if (body.contains(p, -1e-6)) {
            ASSERT_TRUE(inside) << p.x << " " << p.y << " " << p.z;
        } else if (inside && !body.contains(p, 1e-6)) {
            ASSERT_LE(core::nearest_surface(*solid.bvh, p).distance, app::round_deviation + 1e-6)
                << p.x << " " << p.y << " " << p.z;
        }
    }
}

/// The true body reaches to each side of the box of its mesh.
void expect_box(const core::Mesh& mesh, const TrueBody& body) {
    const core::Aabb box = mesh.bounds();
    for (int axis = 0; axis < 3; ++axis)
        for (const bool is_high : {false, true}) {
            const double side = is_high ? box.max[axis] : box.min[axis];
            // The middles of the triangles there, and that of all, where a circle touches.
            std::vector<Vec3> middles;
            core::Aabb face;
            for (size_t i = 0; i < mesh.triangles.size(); ++i) {
                const core::Triangle t = mesh.triangle(i);
                if (t.a[axis] != side || t.b[axis] != side || t.c[axis] != side) continue;
                middles.push_back((t.a + t.b + t.c) / 3.0);
                for (const Vec3& p : {t.a, t.b, t.c}) face.extend(p);
            }
            middles.push_back((face.min + face.max) / 2.0);
            bool reached = false;
            for (Vec3 p : middles) {
                p[axis] += is_high ? -2e-6 : 2e-6;
                reached = reached || body.contains(p, 0.0);
            }
            EXPECT_TRUE(reached) << axis << " " << is_high;
        }
}

class EachPreset : public testing::TestWithParam<std::string> {
protected:
    const Preset& preset() const { return *app::find_preset(GetParam()); }
};

TEST_P(EachPreset, IsTheSolidThatItsSizesDescribe) {
    std::mt19937 random(7);
    const core::Mesh standard = app::preset_mesh(preset()).value();
    expect_closed(standard);
    expect_no_self_intersection(standard);
    const TrueBody body = true_body(preset(), PresetSizes(preset().parameters, {}));
    expect_like(standard, body, random, 2000);
    expect_box(standard, body);
}

TEST_P(EachPreset, IsThatSolidForAllSizes) {
    std::mt19937 random(11);
    for (int i = 0; i < 50; ++i) {
        const auto [values, mesh] = random_sizes(preset(), random);
        SCOPED_TRACE(text_of(preset(), values));
        expect_closed(mesh);
        if (mesh.triangles.size() < 3000) expect_no_self_intersection(mesh);
        const TrueBody body = true_body(preset(), PresetSizes(preset().parameters, values));
        expect_like(mesh, body, random, 60);
        if (HasFatalFailure()) return;
    }
}

TEST_P(EachPreset, HasParametersThatASetUpCanHold) {
    const std::set<std::string_view> taken = {
        "name",      "at",    "rotate_deg",     "frame",  "expendable", "mesh",
        "mesh_unit", "solid", "mesh_deviation", "play",   "box",        "cylinder",
        "model",     "axis",  "tolerance",      "margin", "move",       "preset",
        "line",      "code",  "remove",         "number", "length_unit"};
    std::set<std::string_view> keys;
    EXPECT_FALSE(preset().title.empty() || preset().source.empty() || preset().origin.empty());
    for (const app::PresetParameter& p : preset().parameters) {
        EXPECT_TRUE(keys.insert(p.key).second) << p.key;
        EXPECT_FALSE(taken.contains(p.key)) << p.key;
        EXPECT_TRUE(app::fits(p, p.standard)) << p.key;
        EXPECT_TRUE(app::fits(p, p.least) && app::fits(p, p.greatest)) << p.key;
        EXPECT_FALSE(p.meaning.empty());
    }
}

TEST_P(EachPreset, RefusesValuesThatItCannotHave) {
    const double infinite = std::numeric_limits<double>::infinity();
    const double no_number = std::numeric_limits<double>::quiet_NaN();
    for (const app::PresetParameter& p : preset().parameters)
        for (const double value :
             {no_number, infinite, -infinite, -1.0, p.greatest * 1.001, 1e300, p.least - 0.001,
              p.measure == app::PresetMeasure::count ? 1.5 : -2.0}) {
            const auto mesh = app::preset_mesh(preset(), {{std::string(p.key), value}});
            ASSERT_FALSE(mesh) << p.key << " " << value;
            EXPECT_THAT(mesh.error().message, HasSubstr(std::string(p.key) + " must be"));
        }
    const auto mesh = app::preset_mesh(preset(), {{"jaw_colour", 5.0}});
    ASSERT_FALSE(mesh);
    EXPECT_THAT(mesh.error().message, HasSubstr("has no size jaw_colour; it has: "));
    const std::string key(preset().parameters.back().key);
    const auto misspelt = app::preset_mesh(preset(), {{key + "s", 5.0}});
    ASSERT_FALSE(misspelt);
    EXPECT_THAT(misspelt.error().message, HasSubstr("did you mean " + key + "?"));
}

std::vector<std::string> preset_names() {
    std::vector<std::string> names;
    for (const Preset& preset : app::presets()) names.emplace_back(preset.name);
    return names;
}

INSTANTIATE_TEST_SUITE_P(Presets, EachPreset, testing::ValuesIn(preset_names()),
                         [](const auto& each) {
                             std::string name = each.param;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

// --- volumes, by formulas of their own ---

double volume(const char* name, const PresetValues& values = {}) {
    return core::signed_volume(app::preset_mesh(*app::find_preset(name), values).value());
}

TEST(PresetVolume, OfBlocksIsExact) {
    // The bodies of assets/meshes: the 6 inch vise without the chamfers of its jaws, and the step
    // block.
    const double vise = (152.0 * 28 + 120 * 45) * 405 + (60 + 85) * 45 * 152.0;
    EXPECT_NEAR(volume("vise-6", {{"jaw_width", 152}, {"base_width", 152}, {"screw_length", 0}}),
                vise, 1e-6 * vise);
    EXPECT_NEAR(volume("step-block"), 12.0 * (12 + 20 + 28 + 36 + 44) * 30, 1e-6);
    EXPECT_NEAR(volume("1-2-3-block"), 6 * std::pow(25.4, 3), 1e-6);
    EXPECT_NEAR(volume("2-4-6-block"), 48 * std::pow(25.4, 3), 1e-6);
    EXPECT_NEAR(volume("t-slot-table-14"), 600.0 * (250 * 60 - 3 * (14 * 23 + 9 * 9)), 1e-4);
    EXPECT_NEAR(volume("tombstone"), 400.0 * 400 * 40 + 200.0 * 200 * 400, 1e-4);
}

TEST(PresetVolume, OfRoundBodiesIsThatOfTheCircleOrALittleMore) {
    const auto disc = [](double diameter) { return M_PI * diameter * diameter / 4; };
    const auto rim = [](double diameter) { return M_PI * (diameter + 0.1) * app::round_deviation; };
    const double stud = disc(24) * 4 + std::sqrt(3) / 2 * 18 * 18 * 18 + disc(12) * 60;
    EXPECT_GT(volume("stud-m12"), stud);
    EXPECT_LT(volume("stud-m12"), stud + rim(24) * 4 + rim(12) * 60);
    const double plate = 300.0 * 200 * 25 - 24 * disc(12) * 25;
    EXPECT_GT(volume("fixture-plate"), plate);
    EXPECT_LT(volume("fixture-plate"), plate + 24 * rim(12) * 25);
    const double chuck = (disc(160) - disc(42)) * 88.5 + 3 * 45 * 22 * 44;
    EXPECT_GT(volume("3-jaw-chuck-6"), chuck);
    EXPECT_LT(volume("3-jaw-chuck-6"), chuck + (rim(160) + rim(42)) * 88.5);
    const double hex = std::sqrt(3) / 2 * 44.45 * 44.45 * 76 + disc(60) * 15 - disc(28) * 91;
    EXPECT_GT(volume("collet-block-hex"), hex);
    EXPECT_LT(volume("collet-block-hex"), hex + rim(60) * 15 + rim(28) * 91);
}

TEST(PresetFeatures, AreThoseThatAUserPointsAt) {
    const auto features = [](const char* name) {
        return core::features_of(app::preset_mesh(*app::find_preset(name)).value());
    };
    int jaws = 0;
    for (const core::PlanarFace& face : features("vise-6").faces)
        if (std::abs(face.normal.y) == 1 && std::abs(face.area - 152.4 * 45) < 1e-6) ++jaws;
    EXPECT_EQ(jaws, 4); // front and back of both
    int holes = 0;
    for (const core::RoundWall& wall : features("fixture-plate").walls)
        if (wall.through() && std::abs(wall.radius_from - 6) < 1e-9) ++holes;
    EXPECT_EQ(holes, 24);
    int bodies = 0;
    for (const core::RoundWall& wall : features("3-jaw-chuck-6").walls)
        if (wall.full && wall.kind == core::RoundKind::boss && wall.radius_from > 80
            && wall.radius_from < 80.06)
            ++bodies;
    EXPECT_EQ(bodies, 1);
}

// --- vises ---

TEST(ViseFit, TouchesABoxWithBothJaws) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-300, 300), share(0.01, 1);
    for (const char* name : {"vise-4", "vise-5", "vise-6"}) {
        const Preset& vise = *app::find_preset(name);
        for (int i = 0; i < 40; ++i) {
            core::Aabb box;
            box.min = {place(random), place(random), place(random)};
            box.max =
                box.min
                + Vec3(10 + 100 * share(random),
                       vise.parameter("opening")->greatest * share(random), 60 * share(random));
            const double height = PresetSizes(vise.parameters, {})["jaw_height"];
            const double depth = std::fmin(height, box.max.z - box.min.z) * share(random);
            const app::ViseFit fit = app::vise_around(vise, {}, box, depth).value();
            core::Mesh mesh = app::preset_mesh(vise, {{"opening", fit.opening}}).value();
            for (Vec3& v : mesh.vertices) v += fit.at;
            // The nearest faces on either side of the box, in the jaws.
            double above = core::infinity, below = core::infinity;
            for (const Vec3& v : mesh.vertices) {
                if (v.z < fit.at.z + height - 1e-9) continue;
                if (v.y > (box.min.y + box.max.y) / 2)
                    above = std::fmin(above, v.y - box.max.y);
                else
                    below = std::fmin(below, box.min.y - v.y);
            }
            EXPECT_EQ(above, 0.0);
            EXPECT_NEAR(below, 0.0, 1e-12);
            EXPECT_NEAR(fit.at.z + height, box.min.z + depth, 1e-12);
            EXPECT_NEAR(fit.at.x, (box.min.x + box.max.x) / 2, 1e-12);
        }
    }
}

/// A turned vise holds a box as the vise that is not turned holds the box turned back.
TEST(ViseFit, HoldsABoxFromEachSide) {
    const Preset& vise = *app::find_preset("vise-6");
    const core::Aabb box{{10, -20, 5}, {100, 40, 35}};
    const double height = PresetSizes(vise.parameters, {})["jaw_height"];
    for (int turns = -1; turns < 6; ++turns) {
        SCOPED_TRACE(turns);
        const app::ViseFit fit = app::vise_around(vise, {}, box, 12, turns).value();
        const core::Mat3 turned = core::rotation_xyz_deg(Vec3(0, 0, 90.0 * turns));
        core::Mesh mesh = app::preset_mesh(vise, {{"opening", fit.opening}}).value();
        double fixed = core::infinity, moving = core::infinity;
        const Vec3 middle = 0.5 * (box.min + box.max), half = 0.5 * box.size();
        const Vec3 across = turned * Vec3(0, 1, 0);
        const double reach = std::abs(across.x) * half.x + std::abs(across.y) * half.y;
        EXPECT_NEAR(fit.opening, 2.0 * reach, 1e-9);
        for (const Vec3& vertex : mesh.vertices) {
            const Vec3 p = turned * vertex + fit.at;
            if (p.z < fit.at.z + height - 1e-9) continue;
            const double side = glm::dot(p - middle, across);
            double& nearest = side > 0.0 ? fixed : moving;
            nearest = std::min(nearest, std::abs(side) - reach);
        }
        EXPECT_NEAR(fixed, 0.0, 1e-9);
        EXPECT_NEAR(moving, 0.0, 1e-9);
        EXPECT_NEAR(glm::dot(fit.at - middle, glm::cross(across, Vec3(0, 0, 1))), 0.0, 1e-9);
    }
}

TEST(ViseFit, RefusesWhatTheViseCannotHold) {
    const Preset& vise = *app::find_preset("vise-4");
    const auto error = [&](const Vec3& size, double depth) {
        core::Aabb box;
        box.extend(Vec3(0.0));
        box.extend(size);
        const auto fit = app::vise_around(vise, {}, box, depth);
        return fit ? std::string() : fit.error().message;
    };
    EXPECT_EQ(error({50, 50, 30}, 10), "");
    EXPECT_THAT(error({50, 131, 30}, 10), HasSubstr("vise-4 opens from 0.5 to 130 mm"));
    EXPECT_THAT(error({50, 50, 30}, 31), HasSubstr("at most 30 mm"));
    EXPECT_THAT(error({50, 50, 80}, 33), HasSubstr("at most 32 mm"));
    EXPECT_THAT(error({50, 50, 80}, 0), HasSubstr("more than 0"));
    EXPECT_THAT(error({50, 50, 80}, std::nan("")), HasSubstr("more than 0"));
}

// --- the list ---

TEST(PresetList, IsSortedWithNumbersByTheirValues) {
    EXPECT_TRUE(app::is_before_in_list("vise-4", "vise-10"));
    EXPECT_FALSE(app::is_before_in_list("vise-10", "vise-4"));
    EXPECT_TRUE(app::is_before_in_list("EM6", "EM10"));
    EXPECT_TRUE(app::is_before_in_list("vise", "vise-4"));
    EXPECT_TRUE(app::is_before_in_list("a-99999999999999999999998", "a-99999999999999999999999"));
    EXPECT_NE(app::is_before_in_list("m08", "m8"), app::is_before_in_list("m8", "m08"));
    EXPECT_FALSE(app::is_before_in_list("vise-4", "vise-4"));
    std::vector<std::string> clamps;
    for (const Preset& preset : app::presets())
        if (preset.name.starts_with("strap")) clamps.emplace_back(preset.name);
    EXPECT_THAT(clamps, testing::ElementsAre("strap-clamp-m8", "strap-clamp-m10", "strap-clamp-m12",
                                             "strap-clamp-m16"));
    std::vector<std::string> chucks;
    for (const Preset& preset : app::presets())
        if (preset.name.starts_with("3-jaw")) chucks.emplace_back(preset.name);
    EXPECT_THAT(chucks, testing::ElementsAre("3-jaw-chuck-6", "3-jaw-chuck-8", "3-jaw-chuck-12"));
}

TEST(PresetList, SuggestsTheNearestName) {
    EXPECT_THAT(app::unknown_preset_text("vice-6"), HasSubstr("did you mean \"vise-6\"?"));
    EXPECT_THAT(app::unknown_preset_text("xyz"), HasSubstr("\"feeler presets\" lists all"));
    EXPECT_THAT(app::unknown_preset_text(""), HasSubstr("\"feeler presets\" lists all"));
}

TEST(PresetSolid, RefusesPartsThatOnlyTouch) {
    const auto error = [](const app::PresetSolid& solid) {
        const auto mesh = solid.mesh();
        return mesh ? std::string() : mesh.error().message;
    };
    app::PresetSolid edge(2), corner(2), apart(2), empty(2);
    edge.add(app::rectangle({0, 0}, {1, 1}), 0, 1);
    edge.add(app::rectangle({1, 1}, {2, 2}), 0, 1);
    corner.add(app::rectangle({0, 0}, {1, 1}), 0, 1);
    corner.add(app::rectangle({1, 1}, {2, 2}), 1, 2);
    apart.add(app::rectangle({0, 0}, {1, 1}), 0, 1);
    apart.add(app::rectangle({2, 0}, {3, 1}), 0, 1);
    empty.add(app::rectangle({0, 0}, {1, 1}), 0, 1);
    empty.cut(app::rectangle({-1, -1}, {2, 2}), 0, 1);
    for (const app::PresetSolid* solid : {&edge, &corner, &apart})
        EXPECT_THAT(error(*solid), HasSubstr("several bodies"));
    EXPECT_THAT(error(empty), HasSubstr("nothing is left"));
    EXPECT_THAT(error(app::PresetSolid(0)), HasSubstr("nothing is left"));
}

TEST(PresetSolid, IsClosedOrRefusedWhereSidesNearlyAgree) {
    std::mt19937 random(1);
    const double slips[] = {0, 0, 0, 1e-14, 1e-12, -1e-8, 9e-8, -1e-7, 1.1e-7, 2e-7, 1e-6};
    const auto near_whole = [&](int most) {
        return static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most
               + slips[random() % std::size(slips)];
    };
    int solids = 0;
    for (int i = 0; i < 3000; ++i) {
        app::PresetSolid solid(2);
        for (int k = 0; k < 5; ++k) {
            const app::PlanPoint at{near_whole(4), near_whole(4)};
            const double size = 1 + std::abs(near_whole(4)), low = near_whole(3);
            const double turn = static_cast<double>(random() % 24) * M_PI / 12;
            const app::Outline outlines[] = {
                app::around_circle(at, size), app::within_circle(at, size), app::hexagon(at, size),
                app::rectangle(at, {at[0] + size, at[1] + 2}),
                app::turned(app::rectangle(at, {at[0] + size, at[1] + 2}), std::cos(turn),
                            std::sin(turn))};
            const app::Outline& outline = outlines[random() % std::size(outlines)];
            const double high = low + 1 + std::abs(near_whole(2));
            k < 3 || random() % 2 == 0 ? solid.add(outline, low, high)
                                       : solid.cut(outline, low, high);
        }
        if (const auto mesh = solid.mesh()) {
            ++solids;
            expect_closed(*mesh);
        }
    }
    EXPECT_GT(solids, 300);
}

TEST(PresetSolid, IsTheUnionOfRandomPrisms) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-6, 6), size(4, 15), share(0, 1);
    int solids = 0;
    for (int i = 0; i < 400; ++i) {
        const int axis = static_cast<int>(3 * share(random));
        app::PresetSolid solid(axis);
        struct Prism {
            app::Outline outline;
            double low, high;
            bool fills;
        };
        std::vector<Prism> prisms;
        for (int k = 0; k < 6; ++k) {
            const app::PlanPoint at{place(random), place(random)};
            const double radius = size(random), low = place(random), turn = 3 * share(random);
            app::Outline outline =
                share(random) < 0.4   ? app::around_circle(at, radius)
                : share(random) < 0.5 ? app::hexagon(at, radius)
                                      : app::turned(app::rectangle(at, {at[0] + radius, at[1] + 5}),
                                                    std::cos(turn), std::sin(turn));
            prisms.push_back({outline, low, low + size(random), k < 2 || share(random) < 0.6});
        }
        for (const Prism& p : prisms)
            p.fills ? solid.add(p.outline, p.low, p.high) : solid.cut(p.outline, p.low, p.high);
        const auto mesh = solid.mesh();
        if (!mesh) continue;
        ++solids;
        expect_closed(*mesh);
        const core::Aabb box = mesh->bounds();
        for (int k = 0; k < 60; ++k) {
            Vec3 p;
            for (int d = 0; d < 3; ++d) p[d] = box.min[d] + share(random) * box.size()[d];
            bool inside = false;
            for (const Prism& prism : prisms) {
                bool in = p[axis] > prism.low && p[axis] < prism.high;
                for (size_t c = 0; c < prism.outline.size(); ++c) {
                    const auto &a = prism.outline[c],
                               &b = prism.outline[(c + 1) % prism.outline.size()];
                    in = in
                         && (b[0] - a[0]) * (p[(axis + 2) % 3] - a[1])
                                    - (b[1] - a[1]) * (p[(axis + 1) % 3] - a[0])
                                > 0;
                }
                if (in) inside = prism.fills;
            }
            ASSERT_EQ(is_inside(*mesh, p), inside) << i;
        }
    }
    EXPECT_GT(solids, 50);
}

} // namespace
} // namespace app_test
