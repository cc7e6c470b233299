#include "core/formats/freecad_document.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "core/base/text.h"

namespace core {
namespace {

/// A text in an attribute, without blanks at its ends.
std::string attribute(const pugi::xml_node& node, const char* name, const char* otherwise = "") {
    return std::string(stripped(node.attribute(name).as_string(otherwise)));
}

std::optional<double> number_of(const std::string& text) {
    double number = 0.0;
    const char* const end = text.data() + text.size();
    const auto [rest, failure] = std::from_chars(text.data(), end, number);
    if (failure != std::errc() || rest != end || !std::isfinite(number)) return std::nullopt;
    return number;
}

} // namespace

Result<FreeCadDocument> FreeCadDocument::read(const std::string& path) {
    FEELER_TRY(ZipArchive archive, ZipArchive::open(path));
    FEELER_TRY(const std::string bytes, archive.read("Document.xml", largest_member));
    FEELER_TRY(XmlDocument xml, XmlDocument::parse(bytes, path));
    FreeCadDocument document(std::move(archive), std::move(xml));
    document.take_objects();
    return document;
}

void FreeCadDocument::take_objects() {
    const pugi::xml_node root = xml_.root().child("Document");
    for (const pugi::xml_node& object : root.child("Objects").children("Object"))
        types_.emplace(object.attribute("name").as_string(), object.attribute("type").as_string());
    for (const pugi::xml_node& object : root.child("ObjectData").children("Object")) {
        const std::string name = object.attribute("name").as_string();
        names_.push_back(name);
        for (const pugi::xml_node& property : object.child("Properties").children("Property"))
            properties_[name].emplace(property.attribute("name").as_string(), property);
    }
    for (const std::string& object : names_) {
        ++label_count_[plain_label(object)];
        for (const std::string& member : links(object, "Group"))
            groups_of_[member].push_back(object);
        for (const std::string& member : links(object, "ElementList")) link_members_.insert(member);
    }
}

pugi::xml_node FreeCadDocument::property(const std::string& object, const char* name) const {
    const auto found = properties_.find(object);
    if (found == properties_.end()) return {};
    const auto property = found->second.find(name);
    return property == found->second.end() ? pugi::xml_node() : property->second;
}

std::string FreeCadDocument::text(const std::string& object, const char* name) const {
    return attribute(property(object, name).child("String"), "value");
}

std::string FreeCadDocument::link(const std::string& object, const char* name) const {
    return property(object, name).child("Link").attribute("value").as_string();
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
        texts.push_back(attribute(text, "value"));
    return texts;
}

std::string FreeCadDocument::word(const std::string& object, const char* name) const {
    const pugi::xml_node node = property(object, name);
    const int chosen = node.child("Integer").attribute("value").as_int(-1);
    int index = 0;
    for (const pugi::xml_node& word : node.child("CustomEnumList").children("Enum"))
        if (index++ == chosen) return attribute(word, "value");
    return {};
}

std::optional<double> FreeCadDocument::number(const std::string& object, const char* name) const {
    const pugi::xml_node node = property(object, name);
    for (const char* kind : {"Float", "Integer"})
        if (const auto value = number_of(attribute(node.child(kind), "value"))) return value;
    return std::nullopt;
}

std::optional<Transform> FreeCadDocument::placement(const std::string& object) const {
    const pugi::xml_node place = property(object, "Placement").child("PropertyPlacement");
    Vec3 position(0.0);
    glm::dquat turn(1.0, 0.0, 0.0, 0.0);
    const std::pair<const char*, double*> entries[] = {{"Px", &position.x}, {"Py", &position.y},
                                                       {"Pz", &position.z}, {"Q0", &turn.x},
                                                       {"Q1", &turn.y},     {"Q2", &turn.z}};
    for (const auto& [key, value] : entries) {
        const auto read = number_of(attribute(place, key, "0"));
        if (!read) return std::nullopt;
        *value = *read;
    }
    const auto real = number_of(attribute(place, "Q3", "1"));
    if (!real) return std::nullopt;
    turn.w = *real;
    const double size = glm::length(turn);
    constexpr double usual = 1e-6;
    if (!(std::abs(size - 1.0) <= usual)) return std::nullopt;
    return Transform{glm::mat3_cast(turn / size), position};
}

std::string FreeCadDocument::plain_label(const std::string& object) const {
    const std::string label =
        property(object, "Label").child("String").attribute("value").as_string();
    return label.empty() ? object : label;
}

std::string FreeCadDocument::label(const std::string& object) const {
    const std::string label = plain_label(object);
    const auto count = label_count_.find(label);
    const bool is_shared = count != label_count_.end() && count->second > 1;
    return is_shared ? fmt::format("{} ({})", label, object) : label;
}

std::string FreeCadDocument::shape_file(const std::string& object) const {
    return property(object, "Shape").child("Part").attribute("file").as_string();
}

bool FreeCadDocument::is_link(const std::string& object) const {
    return has(object, "LinkedObject")
           || (has(object, "ElementList") && shape_file(object).empty());
}

std::string FreeCadDocument::type(const std::string& object) const {
    const auto found = types_.find(object);
    return found == types_.end() ? std::string() : found->second;
}

void FreeCadDocument::take_parent(const std::string& parent, int depth, Frame& frame) const {
    const Frame& outer = this->frame(parent, depth + 1);
    const auto refuse = [&frame](const std::string& why) {
        if (frame.why.empty()) frame.why = why;
    };
    refuse(outer.why);
    if (link_members_.contains(parent)) refuse("it is in a group of links");
    std::vector<std::string> names = outer.names;
    names.push_back(label(parent));
    for (std::string& name : names)
        if (std::find(frame.names.begin(), frame.names.end(), name) == frame.names.end())
            frame.names.push_back(std::move(name));
    const std::string kind = type(parent);
    const bool is_part =
        kind == "App::Part" || kind == "PartDesign::Body" || kind == "Assembly::AssemblyObject";
    const auto own = placement(parent);
    if (!own)
        refuse(fmt::format("the place of {} cannot be read", label(parent)));
    else if (!is_part && *own != Transform{}) // an Arch floor moves its members itself
        refuse(fmt::format("{} has a place and is no part", label(parent)));
    if (!is_part && !outer.is_in_part) return;
    const Transform place = is_part ? outer.place * own.value_or(Transform{}) : outer.place;
    if (frame.is_in_part && frame.place != place) refuse("it is in several parts");
    frame.is_in_part = true;
    frame.place = place;
}

const FreeCadDocument::Frame& FreeCadDocument::frame(const std::string& object, int depth) const {
    constexpr int deepest = 100;
    const auto [known, is_new] = frames_.try_emplace(object);
    Frame& frame = known->second; // stays where it is while others are added
    if (!is_new) return frame;
    frame.why = depth > deepest ? "its groups are nested more than 100 deep"
                                : "its groups contain each other"; // if it is asked for meanwhile
    const auto groups = groups_of_.find(object);
    Frame found;
    if (depth > deepest)
        found.why = frame.why;
    else if (groups != groups_of_.end())
        for (const std::string& parent : groups->second) take_parent(parent, depth, found);
    frame = std::move(found);
    return frame;
}

const FreeCadDocument::Frame& FreeCadDocument::frame(const std::string& object) const {
    return frame(object, 0);
}

bool FreeCadDocument::can_be_body(const std::string& object) const {
    const bool has_mesh = !property(object, "Mesh").child("Mesh").attribute("file").empty();
    if (!has(object, "Shape") && !is_link(object) && !has_mesh) return false;
    const auto groups = groups_of_.find(object);
    if (groups != groups_of_.end())
        for (const std::string& group : groups->second)
            if (type(group) == "PartDesign::Body") return false; // a step of it
    for (const char* of_tool_bit : {"BitShape", "BitBody", "ShapeID", "ToolBitID"})
        if (has(object, of_tool_bit)) return false;
    const std::string kind = type(object);
    for (const char* flat : {"Sketcher::", "Part::Part2D", "Part::Datum", "PartDesign::Plane",
                             "PartDesign::Line", "PartDesign::Point", "PartDesign::Coordinate"})
        if (kind.starts_with(flat)) return false;
    return true;
}

std::string FreeCadDocument::why_left_out(const std::string& object) const {
    const std::string name = label(object);
    if (is_link(object)) return fmt::format("{} is a link to other objects: not read", name);
    if (!has(object, "Shape")) return fmt::format("{} is a mesh: not read", name);
    if (link_members_.contains(object))
        return fmt::format("{} is in a group of links: not read", name);
    if (const std::string& why = frame(object).why; !why.empty())
        return fmt::format("{}: {}", name, why);
    if (shape_file(object).empty())
        return fmt::format("{} has no shape: recompute the document in FreeCAD", name);
    return {};
}

FreeCadBody FreeCadDocument::body(const std::string& object) const {
    FreeCadBody body;
    body.shape = shape_file(object);
    body.place = frame(object).place;
    body.names = frame(object).names;
    body.names.push_back(label(object));
    body.why_left_out = why_left_out(object);
    return body;
}

std::vector<FreeCadBody> FreeCadDocument::bodies() const {
    std::vector<FreeCadBody> bodies;
    for (const std::string& object : names_)
        if (can_be_body(object)) bodies.push_back(body(object));
    return bodies;
}

} // namespace core
