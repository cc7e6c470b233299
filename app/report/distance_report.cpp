#include "app/report/distance_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/report/text_layout.h"
#include "core/sim/bound_text.h"

namespace app {
namespace {

using Json = nlohmann::ordered_json;

Json json_point(const core::Vec3& p) { return Json::array({p.x, p.y, p.z}); }

} // namespace

std::string json_distance(const BodyPairDistance& found) {
    Json json;
    json["engine"] = found.engine;
    json["distance"] = found.distance;
    json["lower"] = found.lower;
    json["upper"] = found.upper;
    json["witness"] = Json::array({json_point(found.on_a), json_point(found.on_b)});
    json["at"] = found.at;
    json["points"] = {found.points_a, found.points_b};
    json["sphere_tests"] = found.node_tests;
    json["point_tests"] = found.point_tests;
    json["poses"] = 1; // one search covers a whole sweep
    json["seconds"] = {{"model", found.model_seconds},
                       {"build", found.build_seconds},
                       {"query", found.query_seconds},
                       {"exact", found.exact_seconds}};
    return json.dump(1) + "\n";
}

std::string text_distance(const BodyPairDistance& found, const std::string& a, const std::string& b,
                          bool swept) {
    std::string text = fmt::format("{} to {}\n", trimmed(a), trimmed(b));
    if (found.upper == 0.0)
        text += "  distance      0: they touch or overlap\n";
    else
        text +=
            fmt::format("  distance      {:.6f} mm, certainly between {} and {}\n", found.upper,
                        core::clearance_at_least(found.lower, 9), core::at_most(found.upper, 9));
    text += fmt::format("  scan points   {} mm apart at least, of {} and {} points\n",
                        core::at_least(found.distance, 6), found.points_a, found.points_b);
    text += fmt::format("  nearest       ({:.4f}, {:.4f}, {:.4f}) and ({:.4f}, {:.4f}, {:.4f})",
                        found.on_a.x, found.on_a.y, found.on_a.z, found.on_b.x, found.on_b.y,
                        found.on_b.z);
    if (swept) text += fmt::format("\n                at {:.1f} % of the sweep", 100.0 * found.at);
    text += fmt::format("\n  search        {}: {} {} tests, {} point tests\n", found.engine,
                        found.node_tests, found.engine == "paper" ? "sphere" : "box",
                        found.point_tests);
    text += fmt::format("  seconds       model {:.3f}, tree {:.3f}, query {:.6f}, exact {:.6f}\n",
                        found.model_seconds, found.build_seconds, found.query_seconds,
                        found.exact_seconds);
    return printable(text);
}

} // namespace app
