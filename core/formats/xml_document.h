#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pugixml.hpp>

#include "core/base/result.h"

namespace core {

/// An XML document, in UTF-8 or UTF-16, that knows the lines of its elements. Entities of a DTD are
/// not expanded.
class XmlDocument {
public:
    /// Errors: syntax, with file, line and column.
    static Result<XmlDocument> parse(const std::string& bytes, const std::string& path);

    pugi::xml_node root() const { return document_; }
    const std::string& path() const { return path_; }

    /// The line of an element, counted from 1.
    uint32_t line_of(const pugi::xml_node& node) const;

    /// An error about an element.
    tl::unexpected<Error> refuse(const pugi::xml_node& node, std::string message) const;

private:
    pugi::xml_document document_;
    std::string path_;
    std::vector<size_t> line_ends_; // positions in the text
};

} // namespace core
