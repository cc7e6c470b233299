#include "app/setup/freecad_job.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/base/xml.h"
#include "app/base/zip_archive.h"
#include "app/setup/tools/freecad_bit.h"

namespace app {
namespace {

using nlohmann::json;

/// The objects of a document by name.
class FreeCadDocument {
public:
    static core::Result<FreeCadDocument> read(const std::string& path);

    const std::string& path() const { return xml_.path(); }
    const std::vector<std::string>& names() const { return names_; }

    /// A property of an object; empty if one of them is missing.
    pugi::xml_node property(const std::string& object, const char* name) const;
    bool has(const std::string& object, const char* name) const {
        return !property(object, name).empty();
    }

    std::string text(const std::string& object, const char* name) const {
        return trimmed(property(object, name).child("String").attribute("value").as_string());
    }
    std::string link(const std::string& object, const char* name) const {
        return property(object, name).child("Link").attribute("value").as_string();
    }
    std::vector<std::string> links(const std::string& object, const char* name) const;
    std::vector<std::string> texts(const std::string& object, const char* name) const;

    /// The chosen word of an enumeration.
    std::string word(const std::string& object, const char* name) const;
    std::optional<double> number(const std::string& object, const char* name) const;

private:
    explicit FreeCadDocument(XmlDocument xml) : xml_(std::move(xml)) {}

    XmlDocument xml_;
    std::vector<std::string> names_;
    std::map<std::string, std::map<std::string, pugi::xml_node>> properties_;
};

core::Result<FreeCadDocument> FreeCadDocument::read(const std::string& path) {
    FEELER_TRY(const ZipArchive archive, ZipArchive::open(path));
    FEELER_TRY(const std::string text, archive.read("Document.xml", largest_member));
    FEELER_TRY(XmlDocument xml, XmlDocument::parse(text, path));
    FreeCadDocument document(std::move(xml));
    const pugi::xml_node data = document.xml_.root().child("Document").child("ObjectData");
    for (const pugi::xml_node& object : data.children("Object")) {
        const std::string name = object.attribute("name").as_string();
        document.names_.push_back(name);
        for (const pugi::xml_node& property : object.child("Properties").children("Property"))
            document.properties_[name].emplace(property.attribute("name").as_string(), property);
    }
    return document;
}

pugi::xml_node FreeCadDocument::property(const std::string& object, const char* name) const {
    const auto found = properties_.find(object);
    if (found == properties_.end()) return {};
    const auto property = found->second.find(name);
    return property == found->second.end() ? pugi::xml_node() : property->second;
}

std::vector<std::string> FreeCadDocument::links(const std::string& object, const char* name) const {
    std::vector<std::string> names;
    for (const pugi::xml_node& link : property(object, name).child("LinkList").children("Link"))
        names.emplace_back(link.attribute("value").as_string());
    return names;
}

std::vector<std::string> FreeCadDocument::texts(const std::string& object, const char* name) const {
    std::vector<std::string> texts;
    for (const pugi::xml_node& text : property(object, name).child("StringList").children("String"))
        texts.push_back(trimmed(text.attribute("value").as_string()));
    return texts;
}

std::string FreeCadDocument::word(const std::string& object, const char* name) const {
    const pugi::xml_node node = property(object, name);
    const int chosen = node.child("Integer").attribute("value").as_int(-1);
    int index = 0;
    for (const pugi::xml_node& word : node.child("CustomEnumList").children("Enum"))
        if (index++ == chosen) return trimmed(word.attribute("value").as_string());
    return {};
}

std::optional<double> FreeCadDocument::number(const std::string& object, const char* name) const {
    const pugi::xml_node node = property(object, name);
    for (const char* kind : {"Float", "Integer"})
        if (const auto value = number_in(trimmed(node.child(kind).attribute("value").as_string())))
            return value;
    return std::nullopt;
}

// --- tools
// ----------------------------------------------------------------------------------------

/// The name of the shape of a bit, which differs between versions.
std::string shape_of(const FreeCadDocument& document, const std::string& bit) {
    for (const char* key : {"ShapeName", "ShapeID", "ShapeType", "BitShape"})
        if (std::string name = document.text(bit, key); !name.empty()) return name;
    return {};
}

/// A bit in the form of a .fctb.
json bit_of(const FreeCadDocument& document, const std::string& object) {
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
void add_controller(const FreeCadDocument& document, const std::string& controller,
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

void read_job_tools(const FreeCadDocument& document, const std::string& object, FreeCadJob& job) {
    std::vector<std::string> controllers = document.links(document.link(object, "Tools"), "Group");
    if (controllers.empty()) controllers = document.links(object, "ToolController"); // 0.18
    for (const std::string& controller : controllers) add_controller(document, controller, job);
}

// --- stock
// ----------------------------------------------------------------------------------------

/// Where an object is; empty if it is turned.
std::optional<core::Vec3> place_of(const FreeCadDocument& document, const std::string& object) {
    const pugi::xml_node place = document.property(object, "Placement").child("PropertyPlacement");
    constexpr double straight = 1e-9;
    core::Vec3 position(0.0);
    int axis = 0;
    for (const char* key : {"Px", "Py", "Pz"}) {
        const auto value = number_in(trimmed(place.attribute(key).as_string("0")));
        if (!value) return std::nullopt;
        position[axis++] = *value;
    }
    for (const char* key : {"Q0", "Q1", "Q2"})
        if (!(std::abs(number_in(trimmed(place.attribute(key).as_string("0"))).value_or(1.0))
              <= straight))
            return std::nullopt;
    return position;
}

/// The margins of a stock around the part, such as "X -1 +4".
std::string margins_of(const FreeCadDocument& document, const std::string& stock) {
    std::string text;
    for (const char axis : {'X', 'Y', 'Z'})
        text += fmt::format(
            "{}{} -{:g} +{:g}", text.empty() ? "" : ", ", axis,
            document.number(stock, fmt::format("Ext{}neg", axis).c_str()).value_or(0.0),
            document.number(stock, fmt::format("Ext{}pos", axis).c_str()).value_or(0.0));
    return text;
}

bool is_stock_size(const std::optional<double>& size) {
    constexpr double largest = 1e5; // mm
    return size && *size > 0.0 && *size <= largest;
}

void read_box(const FreeCadDocument& document, const std::string& stock, const core::Vec3& place,
              FreeCadJob& job) {
    core::Vec3 size(0.0);
    int axis = 0;
    for (const char* key : {"Length", "Width", "Height"}) {
        const auto length = document.number(stock, key);
        if (!is_stock_size(length)) return job.notes.push_back("the box of its stock has no size");
        size[axis++] = *length;
    }
    job.stock = core::Solid{core::SolidBox{core::Aabb{place, place + size}}};
}

void read_cylinder(const FreeCadDocument& document, const std::string& stock,
                   const core::Vec3& place, FreeCadJob& job) {
    const auto radius = document.number(stock, "Radius"), height = document.number(stock, "Height");
    if (!is_stock_size(radius) || !is_stock_size(height))
        return job.notes.push_back("the cylinder of its stock has no size");
    job.stock =
        core::Solid{core::SolidCylinder{.base = place, .radius = *radius, .height = *height}};
}

void read_job_stock(const FreeCadDocument& document, const std::string& object, FreeCadJob& job) {
    const std::string stock = document.link(object, "Stock");
    if (document.has(stock, "ExtXneg"))
        return job.notes.push_back(fmt::format(
            "its stock is the part with margins ({} mm). The part is a BREP, which is not "
            "read, so the stock is inferred from the program: state it, or choose "
            "\"Create Box\" for the stock in FreeCAD",
            margins_of(document, stock)));
    const bool is_box = document.has(stock, "Length"), is_round = document.has(stock, "Radius");
    if (!is_box && !is_round)
        return job.notes.push_back("its stock is a solid of its own, a BREP, which is not read: "
                                   "export it as STL and state it as [stock] mesh");
    const auto place = place_of(document, stock);
    if (!place)
        return job.notes.push_back(
            "its stock is turned in FreeCAD and not taken over: state it under [stock]");
    if (is_round)
        read_cylinder(document, stock, *place, job);
    else
        read_box(document, stock, *place, job);
}

/// The objects that are jobs.
std::vector<std::string> jobs_in(const FreeCadDocument& document) {
    std::vector<std::string> jobs;
    for (const std::string& name : document.names())
        if (document.has(name, "PostProcessor") && document.has(name, "Stock"))
            jobs.push_back(name);
    return jobs;
}

} // namespace

core::Result<FreeCadJob> read_freecad_job(const std::string& path) {
    FEELER_TRY(const FreeCadDocument document, FreeCadDocument::read(path));
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
    if (!document.links(document.link(object, "Model"), "Group").empty())
        job.notes.push_back("its part is a BREP, which is not read: export it as STL and state it "
                            "as [part] mesh");
    return job;
}

} // namespace app
