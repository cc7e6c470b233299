#include "core/formats/freecad_document.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
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
    const pugi::xml_node data = document.xml_.root().child("Document").child("ObjectData");
    for (const pugi::xml_node& object : data.children("Object")) {
        const std::string name = object.attribute("name").as_string();
        document.names_.push_back(name);
        for (const pugi::xml_node& property : object.child("Properties").children("Property"))
            document.properties_[name].emplace(property.attribute("name").as_string(), property);
    }
    for (const std::string& group : document.names_)
        for (const std::string& member : document.links(group, "Group"))
            document.group_of_.emplace(member, group);
    return document;
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

std::string FreeCadDocument::label(const std::string& object) const {
    const std::string label = text(object, "Label");
    return label.empty() ? object : label;
}

std::string FreeCadDocument::shape_file(const std::string& object) const {
    return property(object, "Shape").child("Part").attribute("file").as_string();
}

FreeCadBody FreeCadDocument::body(const std::string& object) const {
    FreeCadBody body;
    body.shape = shape_file(object);
    std::set<std::string> seen{object};
    std::vector<std::string> names;
    for (auto group = group_of_.find(object); group != group_of_.end();
         group = group_of_.find(group->second)) {
        const std::string& container = group->second;
        if (!seen.insert(container).second) break; // a damaged file can have groups in circles
        names.insert(names.begin(), label(container));
        const auto place = placement(container);
        if (!place)
            body.why_left_out = fmt::format("the place of {} cannot be read", label(container));
        else
            body.place = *place * body.place;
    }
    names.push_back(label(object));
    for (std::string& name : names)
        if (std::find(body.names.begin(), body.names.end(), name) == body.names.end())
            body.names.push_back(std::move(name));
    if (body.shape.empty())
        body.why_left_out =
            fmt::format("{} is {}, which is not read", label(object),
                        has(object, "LinkedObject") ? "a link to another object" : "a mesh");
    return body;
}

std::vector<FreeCadBody> FreeCadDocument::bodies() const {
    std::vector<FreeCadBody> bodies;
    for (const std::string& object : names_) {
        const bool has_others = has(object, "LinkedObject") || has(object, "Mesh");
        if (shape_file(object).empty() && !has_others) continue;
        const auto group = group_of_.find(object);
        const bool is_step = group != group_of_.end() && !shape_file(group->second).empty();
        const bool is_bit = has(object, "BitShape") || has(object, "BitBody")
                            || has(object, "ShapeID") || has(object, "ToolBitID");
        if (!is_step && !is_bit) bodies.push_back(body(object));
    }
    return bodies;
}

} // namespace core
