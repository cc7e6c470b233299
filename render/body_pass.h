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

/// Meshes that were drawn of late.
class GpuMeshes {
public:
    /// The mesh on the card, brought there if need be.
    const GpuMesh& of(const SharedMesh& mesh);
    /// To be called after each picture: gives back what has not been drawn for a while.
    void end_picture();

private:
    std::unordered_map<const TriangleMesh*, GpuMesh> meshes_;
    uint64_t picture_ = 0;
};

/// Draws what is solid: bodies, stock, faces of a section.
class BodyPass {
public:
    static core::Result<BodyPass> make();

    void draw_opaque(const ViewFrame& frame);
    /// The depths of what is opaque, and nothing else.
    void draw_depths(const ViewFrame& frame);
    /// What is seen through, the farthest first. Needs what is opaque to be there.
    void draw_glass(const ViewFrame& frame);
    /// A ball of so many pixels that nothing hides.
    void draw_mark(const ViewFrame& frame, const Vec3& at, double pixels, Color color);
    void end_picture() { meshes_.end_picture(); }

private:
    /// A body or the stock, as it is drawn.
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
    std::vector<Item> opaque_items(const ViewFrame& frame) const;
    void set_material(const ViewFrame& frame, const Item& item, bool glass) const;
    void draw_faces(const ViewFrame& frame, const Item& item);
    void draw_edges(const ViewFrame& frame, const Item& item);
    void draw_cap(const ViewFrame& frame, const Item& item);
    template <typename Act>
    /// `whole`: of a stock every triangle, not what is drawn in their place.
    void for_meshes(const ViewFrame& frame, const Item& item, const Act& act, bool whole = false);

    ShaderProgram faces_, edges_, caps_;
    GpuMeshes meshes_;
    GlVertexArray no_attributes_;
    SharedMesh ball_;
};

/// Works out how dark it is in corners and hollows, from the depths of what is opaque.
class HollowPass {
public:
    static core::Result<HollowPass> make();

    /// A texture over the whole picture, 1 where nothing darkens; 0 if the card has no room for it.
    /// At half the picture's size.
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
