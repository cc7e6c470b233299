#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/vec.h"
#include "core/formats/xml_document.h"
#include "core/formats/zip_archive.h"

namespace core {

/// An object of a FreeCAD document that can be a body.
struct FreeCadBody {
    std::vector<std::string> names; // labels: of the groups that contain it, and its own last
    Transform place;                // of the parts that contain it; its shape has its own place
    std::string shape;              // the file in the archive that has its shape
    std::string why_left_out;       // a sentence about what cannot be read; empty: it can
};

/// A document of FreeCAD (.FCStd): its objects by name, with their properties.
class FreeCadDocument {
public:
    /// Errors: those of ZipArchive; syntax, with line and column, for damaged XML.
    static Result<FreeCadDocument> read(const std::string& path);

    const std::string& path() const { return archive_.path(); }
    const ZipArchive& archive() const { return archive_; }
    const std::vector<std::string>& names() const { return names_; }

    /// A property of an object; empty if one of them is missing.
    pugi::xml_node property(const std::string& object, const char* name) const;
    bool has(const std::string& object, const char* name) const {
        return !property(object, name).empty();
    }

    std::string text(const std::string& object, const char* name) const;
    std::string link(const std::string& object, const char* name) const;
    std::vector<std::string> links(const std::string& object, const char* name) const;
    std::vector<std::string> texts(const std::string& object, const char* name) const;

    /// The chosen word of an enumeration.
    std::string word(const std::string& object, const char* name) const;
    std::optional<double> number(const std::string& object, const char* name) const;

    /// Its Placement; none if it has numbers that are none.
    std::optional<Transform> placement(const std::string& object) const;

    /// Its label, or its name if it has none. Of several objects with one label, each has its name
    /// after it: "jaw (Box001)".
    std::string label(const std::string& object) const;

    /// The place of the parts that contain it; none if it is not known, with the reason in `why`.
    struct Frame {
        std::vector<std::string> names; // of its groups and parts, the outermost first
        Transform place;
        bool is_in_part = false;
        std::string why;
    };
    const Frame& frame(const std::string& object) const;

    /// All objects that can be bodies, without tool bits, sketches and the steps from which a
    /// PartDesign body is made. What cannot be read is among them, left out: links, meshes, objects
    /// without a shape or whose place is not known. Hidden objects, and those from which others are
    /// made, are bodies, too.
    std::vector<FreeCadBody> bodies() const;

private:
    FreeCadDocument(ZipArchive archive, XmlDocument xml)
        : archive_(std::move(archive)), xml_(std::move(xml)) {}

    void take_objects();
    const Frame& frame(const std::string& object, int depth) const;
    void take_parent(const std::string& parent, int depth, Frame& frame) const;
    std::string plain_label(const std::string& object) const;
    std::string shape_file(const std::string& object) const;
    bool is_link(const std::string& object) const;
    std::string type(const std::string& object) const;
    bool can_be_body(const std::string& object) const;
    std::string why_left_out(const std::string& object) const;
    FreeCadBody body(const std::string& object) const;

    ZipArchive archive_;
    XmlDocument xml_;
    std::vector<std::string> names_;
    std::map<std::string, std::map<std::string, pugi::xml_node>> properties_;
    std::map<std::string, std::string> types_;
    std::map<std::string, std::vector<std::string>> groups_of_; // in which an object is
    std::map<std::string, int> label_count_;
    std::set<std::string> link_members_;
    mutable std::map<std::string, Frame> frames_; // those that were asked for
};

} // namespace core
