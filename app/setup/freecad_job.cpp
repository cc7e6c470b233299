#include "app/setup/freecad_job.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "app/setup/tools/freecad_bit.h"
#include "core/formats/freecad_document.h"

namespace app {
namespace {

using nlohmann::json;

/// The name of the shape of a bit, which differs between versions.
std::string shape_of(const core::FreeCadDocument& document, const std::string& bit) {
    for (const char* key : {"ShapeName", "ShapeID", "ShapeType", "BitShape"})
        if (std::string name = document.text(bit, key); !name.empty()) return name;
    return {};
}

/// A bit in the form of a .fctb.
json bit_of(const core::FreeCadDocument& document, const std::string& object) {
    json bit{{"name", document.text(object, "Label")},
             {"shape", shape_of(document, object)},
             {"parameter", json::object()}};
    for (const char* key :
         {"Diameter", "CuttingEdgeHeight", "CuttingEdgeAngle", "CuttingEdge", "BladeThickness",
          "ShankDiameter", "Length", "OverallLength", "TipAngle", "TipDiameter", "TaperAngle",
          "TaperDiameter", "FlatRadius", "CornerRadius", "TorusRadius", "NeckDiameter",
          "NeckHeight", "NeckLength"})
        if (const auto size = document.number(object, key)) bit["parameter"][key] = *size;
    return bit;
}

/// Adds the tool of a tool controller.
void add_controller(const core::FreeCadDocument& document, const std::string& controller,
                    FreeCadJob& job) {
    constexpr double highest = 99999999.0;
    const double number = document.number(controller, "ToolNumber").value_or(0.0);
    const std::string bit = document.link(controller, "Tool"),
                      label = document.text(controller, "Label");
    const auto leave_out = [&](const std::string& why) {
        job.notes.push_back(fmt::format("tool controller \"{}\" is left out: {}", label, why));
    };
    if (!(number >= 1.0 && number <= highest)) return leave_out("it has no tool number");
    if (bit.empty()) return leave_out("its tool is of an older kind than tool bits");
    auto tool =
        tool_of_freecad_bit(bit_of(document, bit), static_cast<int>(number), document.path());
    if (!tool || !(tool->tool.diameter > 0.0)) return leave_out("its bit has no diameter");
    if (document.word(controller, "SpindleDir") == "Reverse")
        tool->tool.cuts = core::SpindleDirection::counterclockwise;
    const auto [entry, is_new] = job.tools.emplace(tool->tool.number, *tool);
    if (!is_new && entry->second.tool.diameter != tool->tool.diameter)
        leave_out(fmt::format("tool {} is there already, with another diameter", number));
}

void read_job_tools(const core::FreeCadDocument& document, const std::string& object,
                    FreeCadJob& job) {
    std::vector<std::string> controllers = document.links(document.link(object, "Tools"), "Group");
    if (controllers.empty()) controllers = document.links(object, "ToolController"); // 0.18
    for (const std::string& controller : controllers) add_controller(document, controller, job);
}

bool is_stock_size(const std::optional<double>& size) {
    constexpr double largest = 1e5; // mm
    return size && *size > 0.0 && *size <= largest;
}

void read_box(const core::FreeCadDocument& document, const std::string& stock,
              const core::Vec3& place, FreeCadJob& job) {
    core::Vec3 size(0.0);
    int axis = 0;
    for (const char* key : {"Length", "Width", "Height"}) {
        const auto length = document.number(stock, key);
        if (!is_stock_size(length)) return job.notes.push_back("the box of its stock has no size");
        size[axis++] = *length;
    }
    job.stock = core::Solid{core::SolidBox{core::Aabb{place, place + size}}};
}

void read_cylinder(const core::FreeCadDocument& document, const std::string& stock,
                   const core::Vec3& place, FreeCadJob& job) {
    const auto radius = document.number(stock, "Radius"), height = document.number(stock, "Height");
    if (!is_stock_size(radius) || !is_stock_size(height))
        return job.notes.push_back("the cylinder of its stock has no size");
    job.stock =
        core::Solid{core::SolidCylinder{.base = place, .radius = *radius, .height = *height}};
}

/// Whether a body of a job is in a part that is placed elsewhere, or where is not known. Paths of
/// FreeCAD ignore that, and shapes that are read from the document do not.
bool is_moved_by_part(const core::FreeCadDocument& document, const std::string& object) {
    const core::FreeCadDocument::Frame& frame = document.frame(object);
    return !frame.why.empty() || frame.place != core::Transform{};
}

void read_job_stock(const core::FreeCadDocument& document, const std::string& object,
                    FreeCadJob& job) {
    const std::string stock = document.link(object, "Stock");
    if (stock.empty())
        return job.notes.push_back("it has no stock, so the stock is inferred from the program");
    if (is_moved_by_part(document, stock))
        return job.notes.push_back("its stock is in a part that is placed elsewhere, and is not "
                                   "taken over: state it under [stock]");
    const std::string kind =
        document.property(stock, "Proxy").child("Python").attribute("class").as_string();
    const auto place = document.placement(stock);
    const bool is_straight = place && place->rotation == core::Mat3(1.0);
    if (is_straight && kind == "StockCreateBox")
        return read_box(document, stock, place->translation, job);
    if (is_straight && kind == "StockCreateCylinder")
        return read_cylinder(document, stock, place->translation, job);
    job.stock_body = document.label(stock);
    job.stock_is_its_box = is_straight && kind == "StockFromBase";
}

void read_job_part(const core::FreeCadDocument& document, const std::string& object,
                   FreeCadJob& job) {
    const std::string model = document.link(object, "Model");
    const std::vector<std::string> members = document.links(model, "Group");
    if (members.empty()) return;
    const auto is_moved = [&](const std::string& member) {
        return is_moved_by_part(document, member);
    };
    if (std::any_of(members.begin(), members.end(), is_moved))
        return job.notes.push_back("its part is in a part that is placed elsewhere, and is not "
                                   "taken over: state it under [part]");
    job.part_body = document.label(model);
}

/// The objects that are jobs.
std::vector<std::string> jobs_in(const core::FreeCadDocument& document) {
    std::vector<std::string> jobs;
    for (const std::string& name : document.names())
        if (document.has(name, "PostProcessor") && document.has(name, "Stock"))
            jobs.push_back(name);
    return jobs;
}

} // namespace

core::Result<FreeCadJob> read_freecad_job(const std::string& path) {
    FEELER_TRY(const core::FreeCadDocument document, core::FreeCadDocument::read(path));
    const std::vector<std::string> jobs = jobs_in(document);
    if (jobs.empty())
        return tl::unexpected(core::Error{
            core::ErrorCode::syntax, {}, "is a FreeCAD document without a CAM job", path});
    const std::string& object = jobs.front();
    FreeCadJob job;
    job.name = document.text(object, "Label");
    job.post_processor = document.word(object, "PostProcessor");
    job.work_offsets = document.texts(object, "Fixtures");
    if (jobs.size() > 1)
        job.notes.push_back(
            fmt::format("the document has {} jobs, of which the first, \"{}\", is read",
                        jobs.size(), job.name));
    read_job_tools(document, object, job);
    read_job_stock(document, object, job);
    read_job_part(document, object, job);
    return job;
}

} // namespace app
