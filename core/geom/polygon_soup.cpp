#include "core/geom/polygon_soup.h"

#include <exception>
#include <mutex>
#include <sstream>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <fmt/format.h>

namespace core {
namespace {

using namespace OpenMesh;

/// Ends OpenMesh's reading at the first thing that is wrong; never leaves this file.
struct ReadingStopped : std::exception {
    explicit ReadingStopped(std::string reason) : why(std::move(reason)) {}
    std::string why;
};

/// Takes vertices and faces from OpenMesh's readers as they come. A half-edge mesh would drop the
/// faces it cannot join, as where two cubes share an edge.
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
        // The readers themselves do not look whether a number was there.
        if (stream_.fail())
            throw ReadingStopped(fmt::format("vertex {} is not there", vertex.idx() + 1));
        const Vec3 point(p[0], p[1], p[2]);
        if (!is_finite(point))
            throw ReadingStopped(
                fmt::format("vertex {} has a coordinate that is not finite", vertex.idx() + 1));
        soup.vertices[static_cast<size_t>(vertex.idx())] = point;
    }
    FaceHandle add_face(const VHandles& corners) override {
        const size_t face = soup.faces.size();
        if (stream_.fail()) throw ReadingStopped(fmt::format("face {} is not there", face + 1));
        if (corners.size() < 3)
            throw ReadingStopped(fmt::format("face {} has {} corners", face + 1, corners.size()));
        auto& outline = soup.faces.emplace_back();
        for (const VertexHandle corner : corners) {
            if (corner.idx() < 0 || static_cast<size_t>(corner.idx()) >= soup.vertices.size())
                throw ReadingStopped(fmt::format("face {} names vertex {} of {}", face + 1,
                                                 int64_t{corner.idx()} + 1, soup.vertices.size()));
            outline.push_back(static_cast<uint32_t>(corner.idx()));
        }
        return FaceHandle(static_cast<int>(face));
    }
    size_t n_vertices() const override { return soup.vertices.size(); }
    size_t n_faces() const override { return soup.faces.size(); }
    size_t n_edges() const override { return 0; }

    // What a body does not have.
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
            return fail(ErrorCode::syntax, "the file is not understood");
    } catch (const ReadingStopped& stopped) {
        return fail(ErrorCode::syntax, stopped.why);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::invalid_value, "the file does not fit into memory");
    }
    return std::move(importer.soup);
}

} // namespace core
