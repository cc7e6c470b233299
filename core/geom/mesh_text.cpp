#include "core/geom/mesh_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <numeric>
#include <span>
#include <sstream>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <fmt/format.h>

#include "core/base/text.h"
#include "core/geom/line_crossing.h"

namespace core {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

template <typename Number>
std::optional<Number> number_of(std::string_view word) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

} // namespace

bool LineReader::next(Words& words, char comment) {
    words.clear();
    if (rest_.empty()) return false;
    ++line_;
    const size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    line = line.substr(0, line.find(comment));
    for (;;) {
        line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
        if (line.empty()) return true;
        words.push_back(line.substr(0, line.find_first_of(blanks)));
        line.remove_prefix(words.back().size());
    }
}

std::optional<double> coordinate_of(std::string_view word) {
    const auto value = number_of<double>(word);
    if (!value || !(std::abs(*value) <= double{std::numeric_limits<float>::max()}))
        return std::nullopt;
    return value;
}

std::optional<int64_t> integer_of(std::string_view word) { return number_of<int64_t>(word); }

bool equals_ignoring_case(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](char x, char y) { return lower(x) == lower(y); });
}

tl::unexpected<Error> fail_in_line(uint32_t line, const std::string& message) {
    return fail(ErrorCode::syntax, fmt::format("line {}: {}", line, message), {.line = line});
}

Result<FloatPoint> append_point(const Words& words, size_t first, uint32_t line,
                                std::string& text) {
    FloatPoint point{};
    for (size_t i = 0; i < 3; ++i) {
        if (first + i >= words.size())
            return fail_in_line(line, fmt::format("a vertex has {} coordinates", i));
        const auto value = coordinate_of(words[first + i]);
        if (!value)
            return fail_in_line(line, fmt::format("'{}' is not a coordinate", words[first + i]));
        point[i] = static_cast<float>(*value);
        text += ' ';
        text += words[first + i].substr(words[first + i].front() == '+' ? 1 : 0);
    }
    text += '\n';
    return point;
}

namespace {

using namespace OpenMesh;

/// Stops OpenMesh at the first error; never leaves this file.
struct ReadingStopped : std::exception {
    explicit ReadingStopped(std::string reason) : why(std::move(reason)) {}
    std::string why;
};

/// Collects vertices and faces from OpenMesh's readers. A half-edge mesh would drop the faces that
/// it cannot join, for example where two cubes share an edge.
class SoupImporter final : public IO::BaseImporter {
public:
    explicit SoupImporter(const std::istream& stream) : stream_(stream) {}
    PolygonSoup soup;

    VertexHandle add_vertex(const Vec3f& p) override {
        const VertexHandle handle = add_vertex();
        set_point(handle, p);
        return handle;
    }
    VertexHandle add_vertex() override {
        soup.vertices.emplace_back(0.0);
        return VertexHandle(static_cast<int>(soup.vertices.size() - 1));
    }
    void set_point(VertexHandle vertex, const Vec3f& p) override {
        // The readers do not check whether a number was read.
        if (stream_.fail())
            throw ReadingStopped(fmt::format("vertex {} is missing", vertex.idx() + 1));
        const Vec3 point(p[0], p[1], p[2]);
        if (!is_finite(point))
            throw ReadingStopped(
                fmt::format("vertex {} has a coordinate that is not finite", vertex.idx() + 1));
        soup.vertices[static_cast<size_t>(vertex.idx())] = point;
    }
    FaceHandle add_face(const VHandles& corners) override {
        const size_t face = soup.faces.size();
        if (stream_.fail()) throw ReadingStopped(fmt::format("face {} is missing", face + 1));
        if (corners.size() < 3)
            throw ReadingStopped(fmt::format("face {} has {} corners", face + 1, corners.size()));
        auto& outline = soup.faces.emplace_back();
        for (const VertexHandle corner : corners) {
            if (corner.idx() < 0 || static_cast<size_t>(corner.idx()) >= soup.vertices.size())
                throw ReadingStopped(fmt::format("face {} refers to vertex {} of {}", face + 1,
                                                 int64_t{corner.idx()} + 1, soup.vertices.size()));
            outline.push_back(static_cast<uint32_t>(corner.idx()));
        }
        return FaceHandle(static_cast<int>(face));
    }
    size_t n_vertices() const override { return soup.vertices.size(); }
    size_t n_faces() const override { return soup.faces.size(); }
    size_t n_edges() const override { return 0; }

    // Properties that a body does not have.
    HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
    FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f>&) override {}
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
    void set_face_texindex(FaceHandle, int) override {}
    void set_halfedge(VertexHandle, HalfedgeHandle) override {}
    void set_normal(VertexHandle, const Vec3f&) override {}
    void set_normal(VertexHandle, const Vec3d&) override {}
    void set_color(VertexHandle, const Vec3uc&) override {}
    void set_color(VertexHandle, const Vec4uc&) override {}
    void set_color(VertexHandle, const Vec3f&) override {}
    void set_color(VertexHandle, const Vec4f&) override {}
    void set_texcoord(VertexHandle, const Vec2f&) override {}
    void set_texcoord(VertexHandle, const Vec3f&) override {}
    void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
    void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
    void set_status(VertexHandle, const Attributes::StatusInfo&) override {}
    void set_status(HalfedgeHandle, const Attributes::StatusInfo&) override {}
    void set_status(EdgeHandle, const Attributes::StatusInfo&) override {}
    void set_status(FaceHandle, const Attributes::StatusInfo&) override {}
    void set_next(HalfedgeHandle, HalfedgeHandle) override {}
    void set_face(HalfedgeHandle, FaceHandle) override {}
    void request_face_texcoords2D() override {}
    void set_color(EdgeHandle, const Vec3uc&) override {}
    void set_color(EdgeHandle, const Vec4uc&) override {}
    void set_color(EdgeHandle, const Vec3f&) override {}
    void set_color(EdgeHandle, const Vec4f&) override {}
    void set_normal(FaceHandle, const Vec3f&) override {}
    void set_normal(FaceHandle, const Vec3d&) override {}
    void set_color(FaceHandle, const Vec3uc&) override {}
    void set_color(FaceHandle, const Vec4uc&) override {}
    void set_color(FaceHandle, const Vec3f&) override {}
    void set_color(FaceHandle, const Vec4f&) override {}
    void add_texture_information(int, std::string) override {}

private:
    const std::istream& stream_;
};

const char* extension_of(MeshFormat format) {
    switch (format) {
    case MeshFormat::obj:
        return "obj";
    case MeshFormat::off:
        return "off";
    case MeshFormat::ply:
        return "ply";
    default:
        return "stl";
    }
}

} // namespace

Result<PolygonSoup> read_soup(const std::string& bytes, MeshFormat format) {
    // OpenMesh's readers are singletons with state, and print.
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    omerr().disable();
    std::istringstream stream(bytes, std::ios::binary);
    SoupImporter importer(stream);
    IO::Options options =
        format == MeshFormat::stl_binary ? IO::Options::Binary : IO::Options::Default;
    try {
        if (!IO::IOManager().read(stream, extension_of(format), importer, options))
            return fail(ErrorCode::syntax, "the format of the file is not valid");
    } catch (const ReadingStopped& stopped) {
        return fail(ErrorCode::syntax, stopped.why);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::invalid_value, "the file does not fit into memory");
    }
    return std::move(importer.soup);
}

namespace {

/// Ear clipping of one outline, seen along its normal.
class EarCutter {
public:
    EarCutter(const std::vector<Vec3>& vertices, std::span<const uint32_t> face) : face_(face) {
        Vec3 normal(0.0);
        for (size_t i = 0; i < face.size(); ++i)
            normal += glm::cross(vertices[face[i]] - vertices[face[0]],
                                 vertices[face[(i + 1) % face.size()]] - vertices[face[0]]);
        const Vec3 size = glm::abs(normal);
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const uint32_t i : face)
            flat_.push_back(normal[axis] < 0.0 ? Vec2(vertices[i][v], vertices[i][u])
                                               : Vec2(vertices[i][u], vertices[i][v]));
        rest_.resize(face.size());
        std::iota(rest_.begin(), rest_.end(), size_t{0});
    }

    /// Adds the triangles; false if at some point no corner can be cut off.
    bool cut_into(std::vector<Mesh::Corners>& triangles) {
        while (rest_.size() > 3) {
            size_t ear = 0;
            while (ear < rest_.size() && !is_ear(ear)) ++ear;
            if (ear == rest_.size()) return false;
            add_ear(ear, triangles);
            rest_.erase(rest_.begin() + static_cast<std::ptrdiff_t>(ear));
        }
        add_ear(1, triangles);
        return true;
    }

private:
    size_t before(size_t i) const { return rest_[(i + rest_.size() - 1) % rest_.size()]; }
    size_t after(size_t i) const { return rest_[(i + 1) % rest_.size()]; }

    bool is_ear(size_t i) const {
        const Vec2 &a = flat_[before(i)], &b = flat_[rest_[i]], &c = flat_[after(i)];
        const double area = orientation(a, b, c);
        if (area < 0.0) return false;
        return std::none_of(rest_.begin(), rest_.end(), [&](size_t other) {
            const Vec2& p = flat_[other];
            if (p == a || p == b || p == c) return false;
            return orientation(a, b, p) >= 0.0 && orientation(b, c, p) >= 0.0
                   && orientation(c, a, p) >= 0.0;
        });
    }

    void add_ear(size_t i, std::vector<Mesh::Corners>& triangles) const {
        triangles.push_back({face_[before(i)], face_[rest_[i]], face_[after(i)]});
    }

    std::span<const uint32_t> face_;
    std::vector<Vec2> flat_;
    std::vector<size_t> rest_; // corners not cut off yet
};

} // namespace

Result<Mesh> triangulated(PolygonSoup soup) {
    constexpr size_t most_corners = 4096; // cutting takes up to the cube of this number of steps
    Mesh mesh;
    mesh.vertices = std::move(soup.vertices);
    mesh.triangles.reserve(soup.faces.size());
    for (size_t i = 0; i < soup.faces.size(); ++i) {
        const auto& face = soup.faces[i];
        if (face.size() == 3) {
            mesh.triangles.push_back({face[0], face[1], face[2]});
            continue;
        }
        if (face.size() > most_corners)
            return fail(ErrorCode::unsupported, fmt::format("face {} has {} corners, more than {}",
                                                            i + 1, face.size(), most_corners));
        if (!EarCutter(mesh.vertices, face).cut_into(mesh.triangles))
            return fail(ErrorCode::invalid_value,
                        fmt::format("the outline of face {} crosses itself", i + 1));
    }
    return mesh;
}

} // namespace core
