#pragma once

#include <unordered_map>

#include "render/gl_objects.h"
#include "render/triangle_mesh.h"
#include "render/view_frame.h"

namespace render {

/// A mesh on the graphics card.
struct GpuMesh {
    GlVertexArray faces, lines;
    GlBuffer vertices, indices, line_ends;
    int index_count = 0, line_count = 0;
    SharedMesh of; // keeps its address
    uint64_t used = 0;

    void draw_faces() const;
    void draw_lines() const;
};

/// Recently drawn meshes.
class GpuMeshes {
public:
    /// The mesh on the graphics card, uploaded if needed.
    const GpuMesh& of(const SharedMesh& mesh);
    /// Call after each picture: frees meshes that were not drawn for a while.
    void end_picture();

private:
    std::unordered_map<const TriangleMesh*, GpuMesh> meshes_;
    uint64_t picture_ = 0;
};

/// Draws solids: bodies, stock, section faces.
class BodyPass {
public:
    static core::Result<BodyPass> make();

    void draw_opaque(const ViewFrame& frame);
    /// Draws only the depths of opaque bodies.
    void draw_depths(const ViewFrame& frame);
    /// Draws transparent bodies, the farthest first. Call after draw_opaque().
    void draw_glass(const ViewFrame& frame);
    /// Draws a ball of this size in pixels over everything.
    void draw_mark(const ViewFrame& frame, const Vec3& at, double pixels, Color color);
    /// Draws a cone of this radius in pixels over everything, its tip towards `along`.
    void draw_arrow_head(const ViewFrame& frame, const Vec3& at, const Vec3& along, double pixels,
                         Color color);
    void end_picture() { meshes_.end_picture(); }

private:
    /// A body or the stock with its drawing state.
    struct Item {
        const Body* body = nullptr; // null: the stock
        core::Transform pose;
        core::Aabb box; // in the scene
        Color color, second;
        double alpha = 1.0;
        bool cut = false; // by the section plane
        bool closed = true;
    };

    Item item(const ViewFrame& frame, const Body& body, bool is_ghost) const;
    Item stock_item(const ViewFrame& frame) const;
    /// The work before the machine around it, most of which it hides.
    std::vector<Item> opaque_items(const ViewFrame& frame) const;
    void set_material(const ViewFrame& frame, const Item& item, bool glass) const;
    void draw_faces(const ViewFrame& frame, const Item& item);
    void draw_edges(const ViewFrame& frame, const Item& item);
    void draw_cap(const ViewFrame& frame, const Item& item);
    template <typename Act>
    /// Calls `act` for the meshes of an item. `whole`: every triangle of the stock, not the
    /// simplified mesh.
    void for_meshes(const ViewFrame& frame, const Item& item, const Act& act, bool whole = false);

    ShaderProgram faces_, edges_, caps_;
    GpuMeshes meshes_;
    GlVertexArray no_attributes_;
    void draw_symbol(const ViewFrame& frame, const SharedMesh& mesh, const Mat4& scene_from_mesh,
                     Color color);

    SharedMesh ball_, cone_;
};

/// Computes ambient occlusion in corners and hollows from the depths of opaque bodies.
class AmbientOcclusionPass {
public:
    static core::Result<AmbientOcclusionPass> make();

    /// A texture of half the size of the picture with the brightness, 1 where nothing is occluded;
    /// 0 if the card has no memory for it.
    unsigned draw(const ViewFrame& frame, BodyPass& bodies);

private:
    bool resize(const Viewport& size);

    ShaderProgram hollows_, smooth_;
    Viewport size_{0, 0};
    GlTexture depths_, rough_, result_;
    GlFramebuffer to_depths_, to_rough_, to_result_;
    GlVertexArray no_attributes_;
};

} // namespace render
