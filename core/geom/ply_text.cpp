#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "core/geom/mesh_text.h"

namespace core {
namespace {

enum class Form : uint8_t { ascii, little_endian, big_endian };

struct Scalar {
    size_t size;
    bool is_float;
};

struct Property {
    std::string name;
    Scalar value{};
    bool is_list = false;
    Scalar count{};
};

struct Element {
    std::string name;
    size_t count = 0;
    std::vector<Property> properties;
};

const Scalar* scalar_named(std::string_view name) {
    static const std::map<std::string_view, Scalar> scalars = {
        {"char", {1, false}},   {"int8", {1, false}},   {"uchar", {1, false}},
        {"uint8", {1, false}},  {"short", {2, false}},  {"int16", {2, false}},
        {"ushort", {2, false}}, {"uint16", {2, false}}, {"int", {4, false}},
        {"int32", {4, false}},  {"uint", {4, false}},   {"uint32", {4, false}},
        {"float", {4, true}},   {"float32", {4, true}}, {"double", {8, true}},
        {"float64", {8, true}}};
    const auto at = scalars.find(name);
    return at == scalars.end() ? nullptr : &at->second;
}

class PlyReader {
public:
    explicit PlyReader(std::string_view bytes) : rest_(bytes) {}

    Result<MeshText> read() {
        FEELER_TRY([[maybe_unused]] const bool header, read_header());
        std::string points, outlines;
        for (const Element& element : elements_) {
            if (element.properties.empty()) continue;
            const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
            for (size_t i = 0; i < element.count; ++i) {
                FEELER_TRY(const Entry entry, read_entry(element, i));
                Result<bool> added = true;
                if (is_vertex) added = add_point(entry, i, points);
                if (is_face) added = add_outline(entry, i, outlines);
                if (!added) return tl::unexpected(added.error());
            }
            if (is_vertex) out_.vertices += element.count;
            if (is_face) out_.faces = element.count;
            if (is_face) break; // elements after the faces are not part of the surface
        }
        if (out_.faces == 0) return fail(ErrorCode::missing_value, "it has no faces");
        out_.text = plain_header() + points + outlines;
        return std::move(out_);
    }

private:
    Result<bool> read_header() {
        LineReader lines(rest_);
        Words words;
        if (!lines.next(words, '\0') || words.size() != 1 || words[0] != "ply")
            return fail(ErrorCode::syntax, "the file does not begin with 'ply'");
        bool has_format = false;
        while (lines.next(words, '\0')) {
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
            if (words[0] == "end_header") {
                if (!has_format) return fail(ErrorCode::syntax, "its header states no format");
                rest_ = lines.rest();
                return true;
            }
            const bool understood =
                words[0] == "format" ? (has_format = read_format(words)) : read_declaration(words);
            if (!understood)
                return fail_in_line(lines.line(), "this part of the header is not supported");
        }
        return fail_in_line(lines.line(), "the file ends without 'end_header'");
    }

    bool read_format(const Words& words) {
        if (words.size() != 3) return false;
        if (words[1] == "ascii")
            form_ = Form::ascii;
        else if (words[1] == "binary_little_endian")
            form_ = Form::little_endian;
        else if (words[1] == "binary_big_endian")
            form_ = Form::big_endian;
        else
            return false;
        return true;
    }

    bool read_declaration(const Words& words) {
        if (words[0] == "element" && words.size() == 3) {
            const auto count = integer_of(words[2]);
            if (!count || *count < 0 || *count > 1000000000) return false;
            elements_.push_back({std::string(words[1]), static_cast<size_t>(*count), {}});
            return true;
        }
        if (words[0] != "property" || elements_.empty()) return false;
        Property property{.name = std::string(words.back())};
        if (words.size() == 5 && words[1] == "list") {
            const Scalar* const count = scalar_named(words[2]);
            if (count == nullptr || count->is_float) return false;
            property.is_list = true;
            property.count = *count;
        } else if (words.size() != 3) {
            return false;
        }
        const Scalar* const value = scalar_named(words[words.size() - 2]);
        if (value == nullptr) return false;
        property.value = *value;
        elements_.back().properties.push_back(std::move(property));
        return true;
    }

    /// The relevant values of one entry of an element.
    struct Entry {
        std::array<double, 3> point = {NAN, NAN, NAN};
        std::vector<double> outline;
    };

    Result<Entry> read_entry(const Element& element, size_t i) {
        Entry entry;
        for (const Property& property : element.properties) {
            double count = 1.0;
            bool complete = !property.is_list || read_scalar(property.count, count);
            for (double k = 0.0; complete && k < count; k += 1.0) {
                double value = 0.0;
                complete = read_scalar(property.value, value);
                if (property.name == "x") entry.point[0] = value;
                if (property.name == "y") entry.point[1] = value;
                if (property.name == "z") entry.point[2] = value;
                if (complete
                    && (property.name == "vertex_indices" || property.name == "vertex_index"))
                    entry.outline.push_back(value);
            }
            if (!complete)
                return fail(ErrorCode::syntax,
                            fmt::format("{} {} is missing, or its '{}' is not a number",
                                        element.name, i + 1, property.name));
        }
        return entry;
    }

    static Result<bool> add_point(const Entry& entry, size_t i, std::string& points) {
        for (const double x : entry.point) {
            if (!(std::abs(x) <= double{std::numeric_limits<float>::max()}))
                return fail(ErrorCode::invalid_value,
                            fmt::format("vertex {} has a coordinate that is not finite", i + 1));
            points += fmt::format("{} ", static_cast<float>(x));
        }
        points += '\n';
        return true;
    }

    Result<bool> add_outline(const Entry& entry, size_t i, std::string& outlines) const {
        if (entry.outline.size() < 3)
            return fail(ErrorCode::invalid_value,
                        fmt::format("face {} has {} corners", i + 1, entry.outline.size()));
        outlines += fmt::format("{}", entry.outline.size());
        for (const double corner : entry.outline) {
            if (!(corner >= 0.0 && corner < static_cast<double>(out_.vertices)))
                return fail(
                    ErrorCode::invalid_value,
                    fmt::format("face {} refers to vertex {}, but there are {}, counted from 0",
                                i + 1, corner, out_.vertices));
            outlines += fmt::format(" {}", static_cast<uint32_t>(corner));
        }
        outlines += '\n';
        return true;
    }

    std::string plain_header() const {
        return fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\n"
                           "property float y\nproperty float z\nelement face {}\n"
                           "property list int int vertex_indices\nend_header\n",
                           out_.vertices, out_.faces);
    }

    bool read_scalar(const Scalar& scalar, double& value) {
        return form_ == Form::ascii ? read_word(value) : read_binary(scalar, value);
    }

    bool read_word(double& value) {
        const size_t first = rest_.find_first_not_of(" \t\r\n\v\f");
        if (first == std::string_view::npos) return false;
        rest_.remove_prefix(first);
        const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\n\v\f"));
        rest_.remove_prefix(word.size());
        const auto number = coordinate_of(word);
        if (number) value = *number;
        return number.has_value();
    }

    bool read_binary(const Scalar& scalar, double& value) {
        if (rest_.size() < scalar.size) return false;
        uint64_t bits = 0;
        for (size_t i = 0; i < scalar.size; ++i) {
            const size_t at = form_ == Form::big_endian ? i : scalar.size - 1 - i;
            bits = bits << 8U | static_cast<unsigned char>(rest_[at]);
        }
        rest_.remove_prefix(scalar.size);
        if (scalar.is_float && scalar.size == 4) {
            float single = 0.0F;
            const auto low = static_cast<uint32_t>(bits);
            std::memcpy(&single, &low, sizeof single);
            value = single;
        } else if (scalar.is_float) {
            std::memcpy(&value, &bits, sizeof value);
        } else {
            value = static_cast<double>(bits); // a negative index becomes one out of range
        }
        return true;
    }

    std::string_view rest_;
    Form form_ = Form::ascii;
    std::vector<Element> elements_;
    MeshText out_;
};

} // namespace

Result<MeshText> checked_ply(std::string_view bytes) { return PlyReader(bytes).read(); }

} // namespace core
